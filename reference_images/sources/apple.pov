// Source of ../apple.png (its linear output encoded as 8-bit sRGB). Own work, CC0 1.0.
// POV-Ray 3.7, no anti-aliasing, one thread: the pixels are reproducible.
//   povray -D -A +W3000 +H3000 +FE +WT1 +Iapple.pov +Oapple.exr Dither=off
// Apple with stalk on an infinite checkerboard.
#version 3.7;
global_settings { assumed_gamma 1.0 max_trace_level 8 }
#default { finish { ambient 0 diffuse 0.8 } }
camera { perspective location <0,4.3,-5.4> look_at <0,1.55,0> right x*1 up y*1 angle 42 }
// sky: smooth gradient, a bright warm softbox disc (HDR highlight source)
sky_sphere { pigment { gradient y color_map { [0 rgb <1.0,0.86,0.78>] [0.25 rgb <0.85,0.88,0.95>] [1 rgb <0.35,0.50,0.80>] } } }
light_source { <6,9,2> rgb <1.0,0.95,0.88>*1.0 area_light <1.5,0,0>,<0,0,1.5>,9,9 adaptive 2 }
light_source { <-8,6,-6> rgb <0.30,0.34,0.42> shadowless }
light_source { <0,12,-1> rgb 0.25 shadowless }
// bright emissive panel seen only by reflection (gives a > 1 highlight)
sphere { <5.2,9,-3.5>, 1.5 pigment { rgb 1 } finish { emission 12 diffuse 0 } no_shadow no_image }
plane { y,0
  pigment { checker rgb <0.02,0.018,0.02>, rgb <0.93,0.90,0.88> scale 0.75 }
  finish { diffuse 0.75 reflection { 0.02, 0.35 fresnel off } specular 0.0 } }
#declare Skin = texture {
  pigment { bozo turbulence 0.4 scale <0.5,1.2,0.5> color_map { [0 rgb <0.34,0.44,0.045>] [0.6 rgb <0.46,0.55,0.07>] [1 rgb <0.60,0.62,0.13>] } }
  finish { diffuse 0.8 specular 0.35 roughness 0.02 reflection { 0.02, 0.10 falloff 3 } } }
#declare Speck = texture {
  pigment { crackle form <1,0,0> scale 0.13 color_map { [0 rgbt <0.93,0.90,0.62,0.1>] [0.16 rgbt <0.93,0.90,0.62,0.3>] [0.18 rgbt <1,1,1,1>] [1 rgbt <1,1,1,1>] } }
  finish { diffuse 0.8 } }
// profile of the apple: lathe, bezier; starts in the top dimple and ends in the bottom dimple
#declare Apple = lathe { bezier_spline 16,
  <0.00,2.05>,<0.14,2.07>,<0.20,2.36>,<0.52,2.46>
  <0.52,2.46>,<0.90,2.58>,<1.56,2.36>,<1.55,1.50>
  <1.55,1.50>,<1.54,0.80>,<1.05,0.06>,<0.50,0.00>
  <0.50,0.00>,<0.30,-0.02>,<0.20,0.16>,<0.00,0.20>
  sturm }
object { Apple texture { Skin } texture { Speck } }
sphere_sweep { cubic_spline 6, <-0.02,1.8,0>,0.060 <0,2.02,0>,0.060 <0.02,2.35,0.01>,0.052 <0.08,2.64,0.03>,0.062 <0.15,2.86,0.05>,0.085 <0.22,3.0,0.07>,0.09
  tolerance 1e-4
  pigment { gradient y scale 0.3 turbulence 0.3 color_map { [0 rgb <0.14,0.06,0.025>] [1 rgb <0.24,0.12,0.05>] } } finish { diffuse 0.8 specular 0.1 } }
