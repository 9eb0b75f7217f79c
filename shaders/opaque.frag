#version 460
#extension GL_GOOGLE_include_directive : require

#include "shaders/shade.glsl"

void main() { color = vec4(view_color(1.0), 1.0); }
