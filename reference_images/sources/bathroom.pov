// Source of ../bathroom.png (its linear output encoded as 8-bit sRGB). Own work, CC0 1.0.
// POV-Ray 3.7, no anti-aliasing, one thread: the pixels are reproducible.
//   povray -D -A +W3000 +H3000 +FE +WT1 +Ibathroom.pov +Obathroom.exr Dither=off
// Tiled bathroom: small wall tiles with grout, large mirror, chrome taps, bath tub, window; metres.
#version 3.7;
global_settings { assumed_gamma 1.0 max_trace_level 10
 #ifdef(RAD) radiosity { pretrace_start 0.08 pretrace_end 0.01 count 160 nearest_count 8 error_bound 0.6 recursion_limit 2 low_error_factor 0.6 gray_threshold 0.3 minimum_reuse 0.015 brightness 1 } #end }
#ifdef(RAD) #declare Amb=0; #else #declare Amb=0.16; #end
#default { finish { ambient Amb diffuse 0.75 } }
camera { location <0.25,1.55,-1.75> look_at <-0.25,1.08,1.6> right x*1 up y*1 angle 68 }
// ---- tiles: t = tile pitch, g = grout width; a box-shaped pigment via functions
#declare Edge = function(x,y,z) { select( mod(mod(x,y)+y,y) - z, 0, 0, 1) }  // coordinate, pitch, grout width: 0 in the grout, 1 on the tile
#macro Tiles(AX,T,G,ColA,ColB,Gr)
 texture { pigment {
   #switch(AX)
    #case(0) function { Edge(y,T,G)*Edge(z,T,G) } #break
    #case(1) function { Edge(x,T,G)*Edge(z,T,G) } #break
    #case(2) function { Edge(x,T,G)*Edge(y,T,G) } #break
   #end
   pigment_map { [0.5 rgb Gr] [0.5 checker rgb ColA, rgb ColB scale T] } }
  finish { diffuse 0.7 specular 0.25 roughness 0.01 reflection { 0.0, 0.12 } } }
#end
#declare W1=<0.80,0.85,0.86>; #declare W2=<0.74,0.80,0.82>; #declare Gr=<0.42,0.42,0.40>;
#declare B1=<0.06,0.16,0.24>; #declare B2=<0.08,0.22,0.32>;
// floor: 5 cm black/white mosaic
plane { y,0 Tiles(1,0.05,0.004,<0.85,0.84,0.80>,<0.08,0.08,0.09>,<0.35,0.34,0.32>) translate 0.0001*y }
plane { -y,-2.6 pigment { rgb 0.85 } }
// walls
#declare Back = difference { box { <-1.8,0,2.0>,<1.8,2.6,2.1> } box { <0.65,1.25,1.9>,<1.45,2.25,2.2> } }
object { Back texture { pigment { gradient y color_map { [0 rgb 1] [1 rgb 1] } } } Tiles(2,0.1,0.005,W1,W2,Gr) }
box { <-1.8,1.05,1.995>,<1.8,1.15,1.999> texture { pigment { checker rgb B1, rgb B2 scale 0.0125 } finish { diffuse 0.7 reflection { 0.01,0.15 } } } }
box { <-1.9,0,-3>,<-1.8,2.6,2.1> Tiles(0,0.1,0.005,W1,W2,Gr) }
box { <1.8,0,-3>,<1.9,2.6,2.1> Tiles(0,0.1,0.005,B1,B2,<0.55,0.55,0.52>) }
box { <-1.9,0,-3>,<1.9,2.6,-2.9> pigment { rgb <0.6,0.55,0.5> } }
// window: frame with bars, bright sky outside, venetian louvre
box { <0.4,1.0,2.6>,<1.8,2.6,2.61> pigment { gradient y scale 2.6 color_map { [0.4 rgb <0.6,0.75,1>] [1 rgb <0.35,0.55,1>] } } finish { emission 5 diffuse 0 } }
union { box { <0.65,1.25,1.99>,<1.45,1.30,2.05> } box { <0.65,2.20,1.99>,<1.45,2.25,2.05> } box { <0.65,1.25,1.99>,<0.70,2.25,2.05> } box { <1.40,1.25,1.99>,<1.45,2.25,2.05> } box { <1.03,1.25,1.99>,<1.07,2.25,2.05> } box { <0.65,1.73,1.99>,<1.45,1.77,2.05> } pigment { rgb 0.9 } }
light_source { <1.05,1.75,2.4> rgb <0.8,0.9,1.0>*2.2 area_light <0.7,0,0>,<0,0.9,0>,5,5 adaptive 1 fade_distance 1.2 fade_power 2 }
// mirror on the left wall part of the back wall, with frame
box { <-1.45,1.25,1.985>,<0.05,2.15,1.99> pigment { rgb 0.02 } finish { diffuse 0 reflection 0.92 } }
difference { box { <-1.50,1.20,1.96>,<0.10,2.20,1.992> } box { <-1.45,1.25,1.9>,<0.05,2.15,2.0> } pigment { rgb <0.55,0.45,0.3> } finish { specular 0.5 metallic reflection 0.2 } }
// lamp over the mirror: five bulbs
#declare I=0; #while(I<5) sphere { <-1.3+I*0.3,2.32,1.9>,0.045 pigment { rgb 1 } finish { emission <25,20,14> diffuse 0 } no_shadow } cylinder { <-1.3+I*0.3,2.32,1.9>,<-1.3+I*0.3,2.32,2.0>,0.02 pigment { rgb 0.6 } finish { reflection 0.5 } } #declare I=I+1; #end
light_source { <-0.7,2.28,1.8> rgb <1,0.85,0.65>*1.6 area_light <1.2,0,0>,<0,0.05,0>,9,1 fade_distance 1.2 fade_power 2 }
light_source { <0,2.5,-1.5> rgb <1,0.95,0.9>*0.35 }
// vanity with basin and chrome tap
#declare Chrome = texture { pigment { rgb <0.6,0.6,0.62> } finish { ambient 0 diffuse 0.1 specular 0.8 roughness 0.002 metallic reflection { 0.75 metallic } } }
#declare Cer = texture { pigment { rgb 0.92 } finish { diffuse 0.75 specular 0.5 roughness 0.005 reflection { 0.02,0.3 } } }
box { <-1.6,0.25,1.45>,<0.15,0.82,2.0> texture { pigment { wood turbulence 0.06 scale <0.03,0.6,0.03> rotate 3*z color_map { [0 rgb <0.30,0.16,0.07>] [0.8 rgb <0.42,0.25,0.12>] [1 rgb <0.18,0.09,0.04>] } } } }
box { <-1.65,0.82,1.40>,<0.2,0.86,2.0> texture { pigment { granite scale 0.12 color_map { [0 rgb 0.12] [0.5 rgb 0.35] [1 rgb 0.8] } } finish { diffuse 0.7 reflection { 0.02,0.2 } } } }
difference { intersection { sphere { 0,1 scale <0.33,0.17,0.21> } plane { y,0 } } sphere { 0,1 scale <0.315,0.155,0.195> } texture { Cer } translate <-0.72,1.03,1.66> } // vessel basin
difference { torus { 0.09,0.014 rotate 90*x } plane { y,0 } texture { Chrome } rotate 90*y translate <-0.72,1.17,1.80> }
cylinder { <-0.72,0.86,1.89>,<-0.72,1.17,1.89>,0.016 texture { Chrome } }
cylinder { <-0.72,1.13,1.71>,<-0.72,1.17,1.71>,0.014 texture { Chrome } }
sphere { <-0.88,0.92,1.88>,0.035 texture { Chrome } } sphere { <-0.56,0.92,1.88>,0.035 texture { Chrome } }
cylinder { <-0.88,0.86,1.88>,<-0.88,0.92,1.88>,0.015 texture { Chrome } } cylinder { <-0.56,0.86,1.88>,<-0.56,0.92,1.88>,0.015 texture { Chrome } }
// bath tub along the right wall
difference { superellipsoid { <0.25,0.12> rotate 90*x scale <0.42,0.30,0.95> translate <1.36,0.30,0.95> } superellipsoid { <0.35,0.25> rotate 90*x scale <0.35,0.32,0.87> translate <1.36,0.48,0.95> } texture { Cer } }
sphere_sweep { cubic_spline 6, <1.70,0.75,0.5>,0.014 <1.72,0.82,0.5>,0.014 <1.70,0.92,0.5>,0.014 <1.60,0.95,0.5>,0.014 <1.52,0.88,0.5>,0.014 <1.50,0.80,0.5>,0.014 tolerance 1e-4 texture { Chrome } }
// shower rail + hanging towel with fine stripes
cylinder { <0.35,1.02,1.93>,<0.60,1.02,1.93>,0.008 texture { Chrome } }
box { <0.37,0.45,1.915>,<0.58,1.03,1.945> texture { pigment { gradient y scale 0.012 color_map { [0.5 rgb <0.75,0.12,0.10>] [0.5 rgb <0.9,0.88,0.82>] } } } }
// wire basket: thin chrome wires on the floor
#declare I=0; #while(I<24) #declare A=I*15; cylinder { <0.14*cos(radians(A)),0.0,0.14*sin(radians(A))>,<0.17*cos(radians(A)),0.35,0.17*sin(radians(A))>,0.0022 translate <0.55,0,0.9> texture { Chrome } } #declare I=I+1; #end
#declare I=0; #while(I<6) torus { 0.14+I*0.006,0.0022 translate <0.55,0.01+I*0.068,0.9> texture { Chrome } } #declare I=I+1; #end
// glass bottles
#declare I=0; #while(I<3) cylinder { 0,<0,0.16,0>,0.03 translate <-1.45+I*0.09,0.86,1.75> pigment { rgbt <0.85,0.95-0.2*I,0.7+0.1*I,0.75> } finish { specular 0.8 reflection { 0.02,0.5 } } } #declare I=I+1; #end
