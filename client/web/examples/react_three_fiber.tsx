// SPDX-License-Identifier: Apache-2.0
// A session in a scene of react-three-fiber: npm install curvecast three @react-three/fiber react react-dom

import { Canvas, useThree } from "@react-three/fiber";
import { Client, Sampler, socketUrl } from "curvecast";
import { CurvecastPoints } from "curvecast/three";
import { useEffect, useState } from "react";

interface SessionProps {
  server: string; // its HTTP address
  session: string; // id
  token?: string;
  points?: number;
}

/// The points of a session, in the units and the frame of the mesh's file.
export function Session({ server, session, token, points = 30_000 }: SessionProps) {
  const [object, setObject] = useState<CurvecastPoints | null>(null);
  const invalidate = useThree((state) => state.invalidate);
  useEffect(() => {
    const client = new Client({ url: socketUrl(server), token });
    const view = client.view(session, { onFrame: () => invalidate() });
    view.look({ budget: { case: "points", value: BigInt(points) }, sampler: Sampler.PROGRESSIVE });
    const shown = new CurvecastPoints(view.store);
    setObject(shown);
    return () => {
      setObject(null);
      shown.dispose();
      client.close();
    };
  }, [server, session, token, points, invalidate]);
  return object && <primitive object={object} />;
}

/// A page of it. Drawn when points have come, and when something of the scene changes.
export function Page() {
  return (
    <Canvas frameloop="demand" camera={{ position: [0, 2.5, 3], fov: 40 }}>
      <Session server="https://points.example.org/" session="SESSION" token="TOKEN" />
    </Canvas>
  );
}
