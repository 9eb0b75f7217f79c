#version 460
#extension GL_GOOGLE_include_directive : require

#include "shaders/shade.glsl"

void main() { color = displayed(view_color(1.0, vec3(0.0))); }
