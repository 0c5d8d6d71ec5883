// Source of ../cornell.exr (linear half float, as written). Own work, CC0 1.0.
// POV-Ray 3.7, no anti-aliasing, one thread: the pixels are reproducible.
//   povray -D -A +W3000 +H3000 +FE +WT1 +Icornell.pov +Ocornell.exr Dither=off Declare=RAD=1
// Cornell box, published measured dimensions (mm), camera as published; diffuse interreflection by radiosity.
#version 3.7;
global_settings { assumed_gamma 1.0
 #ifdef(RAD) radiosity { pretrace_start 0.08 pretrace_end 0.005 count 400 nearest_count 12 error_bound 0.35 recursion_limit 3 low_error_factor 0.5 gray_threshold 0 minimum_reuse 0.01 brightness 1 always_sample off } #end }
#default { finish { ambient 0 diffuse 1 } }
camera { location <278,273,-800> look_at <278,273,0> right -x*1 up y*1 angle 39.3077 }
#declare White = texture { pigment { rgb <0.73,0.71,0.66> } }
#declare Red   = texture { pigment { rgb <0.61,0.055,0.06> } }
#declare Green = texture { pigment { rgb <0.12,0.43,0.10> } }
#macro Quad(A,B,C,D,T) mesh { triangle { A,B,C } triangle { A,C,D } texture { T } } #end
Quad(<552.8,0,0>,<0,0,0>,<0,0,559.2>,<549.6,0,559.2>,White)
Quad(<556,548.8,0>,<556,548.8,559.2>,<0,548.8,559.2>,<0,548.8,0>,White)
Quad(<549.6,0,559.2>,<0,0,559.2>,<0,548.8,559.2>,<556,548.8,559.2>,White)
Quad(<0,0,559.2>,<0,0,0>,<0,548.8,0>,<0,548.8,559.2>,Green)
Quad(<552.8,0,0>,<549.6,0,559.2>,<556,548.8,559.2>,<556,548.8,0>,Red)
// short block
#macro Block(P1,P2,P3,P4,H)
 #local U=y*H;
 Quad(P1+U,P2+U,P3+U,P4+U,White) Quad(P1,P2,P2+U,P1+U,White) Quad(P2,P3,P3+U,P2+U,White) Quad(P3,P4,P4+U,P3+U,White) Quad(P4,P1,P1+U,P4+U,White)
#end
Block(<130,0,65>,<82,0,225>,<240,0,272>,<290,0,114>,165)
Block(<423,0,247>,<265,0,296>,<314,0,456>,<472,0,406>,330)
// light 130x105 mm
light_source { <278,547.5,279.5> rgb <1.0,0.72,0.42>*5.5 area_light <130,0,0>,<0,0,105>,17,17 adaptive 2 fade_distance 120 fade_power 2
  looks_like { mesh { triangle { <65,0.9,-52.5>,<65,0.9,52.5>,<-65,0.9,52.5> } triangle { <65,0.9,-52.5>,<-65,0.9,52.5>,<-65,0.9,-52.5> } pigment { rgb 1 } finish { emission <17,12,4>  diffuse 0 } } } }
