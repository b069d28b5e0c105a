// SPDX-License-Identifier: Apache-2.0
// Puts the first session of the server into a scene of its own.

import * as THREE from "three";

import { Client, Sampler, SessionState, type Session } from "./stream";
import { CurvecastPoints } from "./view";

const client = new Client();
const session = (await client.listSessions()).find(({ state }) => state === SessionState.READY);
if (session !== undefined) show(session);
else document.body.textContent = "The server has no session that is ready. Open a mesh in the viewer, then load this page again.";

function show({ sessionId, report }: Session): void {
  const { boxMin, boxMax } = report!.mesh!;
  const box = new THREE.Box3(
    new THREE.Vector3(boxMin!.x, boxMin!.y, boxMin!.z),
    new THREE.Vector3(boxMax!.x, boxMax!.y, boxMax!.z),
  );
  const { center, radius } = box.getBoundingSphere(new THREE.Sphere());

  const view = client.view(sessionId);
  view.look({ budget: { case: "points", value: 30_000n }, sampler: Sampler.PROGRESSIVE });

  const scene = new THREE.Scene().add(new CurvecastPoints(view.store), new THREE.Box3Helper(box));
  const camera = new THREE.PerspectiveCamera(40, innerWidth / innerHeight, radius / 10, 10 * radius);
  const renderer = new THREE.WebGLRenderer({ antialias: true });
  renderer.setSize(innerWidth, innerHeight);
  document.body.append(renderer.domElement);
  renderer.setAnimationLoop((time) => {
    camera.position.setFromSphericalCoords(3.2 * radius, 1.3, time / 3000).add(center);
    camera.lookAt(center);
    renderer.render(scene, camera);
  });
}
