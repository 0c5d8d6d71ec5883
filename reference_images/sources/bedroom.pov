// Source of ../bedroom.png (its linear output encoded as 8-bit sRGB). Own work, CC0 1.0.
// POV-Ray 3.7, no anti-aliasing, one thread: the pixels are reproducible.
//   povray -D -A +W3000 +H3000 +FE +WT1 +Ibedroom.pov +Obedroom.exr Dither=off
// Bedroom: bed with plaid duvet, pillows, blinds with thin slats, plank floor, lamp with bright bulb, books, rug; metres.
#version 3.7;
global_settings { assumed_gamma 1.0 max_trace_level 8
 #ifdef(RAD) radiosity { pretrace_start 0.08 pretrace_end 0.01 count 160 nearest_count 8 error_bound 0.6 recursion_limit 2 low_error_factor 0.6 gray_threshold 0.3 minimum_reuse 0.015 brightness 1 } #end }
#ifdef(RAD) #declare Amb=0; #else #declare Amb=0.14; #end
#default { finish { ambient Amb diffuse 0.8 } }
camera { location <2.3,1.65,-2.6> look_at <-0.15,0.72,0.9> right x*1 up y*1 angle 58 }
// sun through blinds + lamp + fill
light_source { <-6,4.2,1.2> rgb <1.0,0.9,0.72>*1.5 parallel point_at <0,0.3,0.3> }
light_source { <-1.9,1.6,0.7> rgb <0.55,0.7,1.0>*0.55 area_light <0,1.0,0>,<0,0,1.2>,5,5 adaptive 1 fade_distance 1.5 fade_power 2 shadowless }
light_source { <0.98,1.02,1.78> rgb <1.0,0.62,0.28>*0.9 fade_distance 0.5 fade_power 2 }
light_source { <1.5,2.4,-2.0> rgb 0.16 shadowless }
// planks
plane { y,0 texture { pigment { brick pigment { rgb <0.05,0.03,0.02> }, pigment { wood turbulence 0.08 scale <0.05,0.05,1.5> translate 0.3*y color_map { [0 rgb <0.36,0.20,0.10>] [0.6 rgb <0.45,0.27,0.14>] [1 rgb <0.28,0.15,0.07>] } } brick_size <1.4,0.11,0.11> mortar 0.004 rotate 90*x } finish { diffuse 0.75 reflection { 0.01,0.15 } } } }
plane { -y,-2.7 pigment { rgb 0.88 } }
// back wall with fine-striped wallpaper; left wall with window hole
box { <-2.2,0,2.2>,<3.5,2.7,2.3> texture { pigment { gradient x scale 0.05 color_map { [0.0 rgb <0.62,0.66,0.60>] [0.62 rgb <0.62,0.66,0.60>] [0.62 rgb <0.74,0.75,0.66>] [0.9 rgb <0.74,0.75,0.66>] [0.9 rgb <0.35,0.42,0.40>] [1 rgb <0.35,0.42,0.40>] } } } }
box { <-2.2,0,2.18>,<3.5,0.12,2.2> pigment { rgb 0.85 } }
difference { box { <-2.3,0,-4>,<-2.2,2.7,2.3> } box { <-2.5,0.85,-0.1>,<-2.0,2.25,1.45> } pigment { rgb <0.80,0.76,0.68> } }
box { <-2.2,0,-4>,<3.5,2.7,-4.1> pigment { rgb <0.7,0.68,0.62> } }
box { <3.5,0,-4>,<3.6,2.7,2.3> pigment { rgb <0.7,0.66,0.6> } }
// bright outside
box { <-4,-1,-4>,<-4.01,5,5> pigment { gradient y scale 5 color_map { [0.1 rgb <0.35,0.5,0.2>] [0.25 rgb <0.9,0.95,1>] [1 rgb <0.3,0.5,1>] } } finish { emission 6 ambient 0 diffuse 0 } no_shadow }
// blinds: 56 slats
#declare I=0; #while(I<56) box { <-0.0125,-0.0006,-0.80>,<0.0125,0.0006,0.80> rotate z*32 translate <-2.17,0.87+I*0.025,0.675> pigment { rgb <0.88,0.85,0.76> } finish { diffuse 0.7 } } #declare I=I+1; #end
#declare I=0; #while(I<3) cylinder { <-2.155,0.85,0.1+I*0.57>,<-2.155,2.28,0.1+I*0.57>,0.0015 pigment { rgb 0.7 } } #declare I=I+1; #end
union { box { <-2.22,0.78,-0.18>,<-2.10,0.84,1.53> } box { <-2.21,2.25,-0.18>,<-2.14,2.33,1.53> } box { <-2.21,0.8,-0.18>,<-2.17,2.3,-0.10> } box { <-2.21,0.8,1.45>,<-2.17,2.3,1.53> } pigment { rgb 0.9 } }
// curtain: wavy isosurface replaced by many cylinders
#declare I=0; #while(I<14) cylinder { <-2.09,0.25,1.55+I*0.035>,<-2.09,2.45,1.55+I*0.035>,0.024+0.006*mod(I,2) texture { pigment { gradient y scale 0.02 color_map { [0.5 rgb <0.45,0.10,0.13>] [0.5 rgb <0.55,0.16,0.17>] } } } } #declare I=I+1; #end
// bed
#declare Plaid = texture { pigment { average pigment_map {
  [1 gradient x scale 0.16 color_map { [0.0 rgb <0.08,0.14,0.32>] [0.45 rgb <0.08,0.14,0.32>] [0.45 rgb <0.85,0.83,0.75>] [0.90 rgb <0.85,0.83,0.75>] [0.9 rgb <0.70,0.10,0.08>] [1 rgb <0.70,0.10,0.08>] }]
  [1 gradient z scale 0.16 color_map { [0.0 rgb <0.08,0.14,0.32>] [0.45 rgb <0.08,0.14,0.32>] [0.45 rgb <0.85,0.83,0.75>] [0.90 rgb <0.85,0.83,0.75>] [0.9 rgb <0.70,0.10,0.08>] [1 rgb <0.70,0.10,0.08>] }]
  [0.7 checker rgb 0.15, rgb 1.0 scale 0.004] } } normal { bumps 0.35 scale 0.18 } finish { diffuse 0.8 } }
superellipsoid { <0.12,0.12> scale <0.95,0.13,1.08> translate <-0.45,0.34,1.02> pigment { rgb <0.85,0.82,0.76> } }
superellipsoid { <0.2,0.15> scale <1.0,0.11,0.85> translate <-0.45,0.49,0.66> texture { Plaid } }
box { <-1.45,0,-0.12>,<0.55,0.30,2.1> texture { pigment { rgb <0.28,0.15,0.08> } } }
superellipsoid { <0.15,0.15> scale <1.05,0.55,0.05> translate <-0.45,0.75,2.12> texture { pigment { wood turbulence 0.1 scale <0.8,0.04,0.04> color_map { [0 rgb <0.25,0.13,0.06>] [1 rgb <0.40,0.22,0.11>] } } } }
#declare Pil = superellipsoid { <0.6,0.9> rotate 90*x scale <0.40,0.13,0.26> }
object { Pil rotate -25*x translate <-0.92,0.64,1.75> pigment { gradient x scale 0.014 color_map { [0.5 rgb <0.9,0.88,0.84>] [0.5 rgb <0.55,0.62,0.75>] } } normal { bumps 0.3 scale 0.12 } }
object { Pil rotate -25*x translate <0.02,0.64,1.75> pigment { gradient x scale 0.014 color_map { [0.5 rgb <0.9,0.88,0.84>] [0.5 rgb <0.55,0.62,0.75>] } } normal { bumps 0.3 scale 0.12 } }
// night stand, lamp, books
box { <0.68,0,1.5>,<1.28,0.52,2.1> pigment { rgb <0.33,0.18,0.09> } } box { <0.71,0.30,1.49>,<1.25,0.49,1.5> pigment { rgb <0.40,0.23,0.12> } } sphere { <0.98,0.4,1.475>,0.018 pigment { rgb <0.8,0.7,0.4> } finish { metallic reflection 0.5 specular 0.6 } }
union { cylinder { <0.98,0.52,1.78>,<0.98,0.54,1.78>,0.09 } cylinder { <0.98,0.52,1.78>,<0.98,0.92,1.78>,0.012 } pigment { rgb <0.7,0.6,0.35> } finish { metallic specular 0.8 reflection 0.35 } }
sphere { <0.98,1.0,1.78>,0.035 pigment { rgb 1 } finish { emission <80,50,22> diffuse 0 } no_shadow }
cone { <0.98,0.88,1.78>,0.19 <0.98,1.14,1.78>,0.12 open texture { pigment { radial frequency 60 color_map { [0.5 rgbt <0.95,0.80,0.55,0.35>] [0.5 rgbt <0.90,0.70,0.45,0.25>] } translate <0.98,0,1.78> } finish { diffuse 0.8 emission 0.35 } } no_shadow }
#declare I=0; #while(I<6) box { <0.72,0.52+I*0.02,1.52>,<0.72+0.13+0.01*mod(I*3,4),0.539+I*0.02,1.70> rotate 0*y pigment { rgb <0.2+0.12*mod(I*2,5),0.15+0.1*mod(I*3,5),0.12+0.11*mod(I*4,5)> } } #declare I=I+1; #end
// picture frames with a line-art print (onion rings)
#macro Frame(X,Y,W,H) box { <X,Y,2.16>,<X+W,Y+H,2.2> pigment { rgb 0.05 } } box { <X+0.03,Y+0.03,2.155>,<X+W-0.03,Y+H-0.03,2.17> texture { pigment { onion scale 0.012 translate <X+W/2,Y+H/2,2.155> color_map { [0.5 rgb 0.95] [0.5 rgb <0.1,0.15,0.3>] } } } } #end
Frame(-0.95,1.45,0.45,0.60) Frame(-0.35,1.45,0.45,0.60)
// rug: fine weave
cylinder { <1.15,0.001,0.2>,<1.15,0.012,0.2>,0.85 texture { pigment { radial frequency 48 color_map { [0.5 rgb <0.75,0.65,0.45>] [0.5 rgb <0.35,0.12,0.10>] } translate <1.15,0,0.2> } } texture { pigment { onion scale 0.085 translate <1.15,0,0.2> color_map { [0.7 rgbt <1,1,1,1>] [0.7 rgbt <0.1,0.12,0.25,0>] } } } }
