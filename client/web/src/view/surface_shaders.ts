// SPDX-License-Identifier: Apache-2.0
// GLSL of the pass that draws the surface's own triangles. OWN_COLOURS: those of the vertices. NORMALS_COLOURS: what normals look like.

export const surfaceVertexShader = /* glsl */ `
precision highp float;
uniform mat4 modelViewMatrix, projectionMatrix;
in vec3 position, normal;
out vec3 place;
centroid out vec3 normalHere;  // in eye coordinates
#ifdef OWN_COLOURS
in vec3 colour;
#endif
#ifndef NONE_COLOURS
centroid out vec3 colourHere;  // squares of sRGB, as of the points
#endif
void main() {
  place = position;
  normalHere = mat3(modelViewMatrix) * normal;
#ifdef OWN_COLOURS
  colourHere = colour * colour;
#elif defined(NORMALS_COLOURS)
  colourHere = (0.5 + 0.5 * normal) * (0.5 + 0.5 * normal);
#endif
  gl_Position = projectionMatrix * (modelViewMatrix * vec4(position, 1.0));
}
`;

export const surfaceFragmentShader = /* glsl */ `
precision highp float;
uniform vec4 section;  // as of the points
in vec3 place;
centroid in vec3 normalHere;
layout(location = 0) out vec4 normalSum;
#ifndef NONE_COLOURS
centroid in vec3 colourHere;
layout(location = 1) out vec4 colourSum;
#endif
void main() {
  if (dot(place, section.xyz) > section.w) discard;
  float size = length(normalHere);
  normalSum = vec4(size > 1e-6 ? normalHere / size : vec3(0.0), 1.0);
#ifndef NONE_COLOURS
  colourSum = vec4(colourHere, 1.0);
#endif
}
`;
