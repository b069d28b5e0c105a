// SPDX-License-Identifier: Apache-2.0
// Numbers that servers and clients agree on: those of the table at the top of curvecast.proto that this client needs.

export const maxPoints = 4_000_000; // points of one point set, or of a frame's list
export const maxCompanions = 256; // files that one mesh refers to
export const radiusRungs = 64; // of the ladder of radii: see PointEdits.radius_max
export const radiusRungsPerOctave = 2; // from one radius to half of it
export const maxSurfaceFaces = 1_000_000; // triangles of a surface that a server sends
