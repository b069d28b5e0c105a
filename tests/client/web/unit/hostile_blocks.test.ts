import { beforeAll, describe, expect, it } from "vitest";

import { readHeader } from "../../../../client/web/src/stream/draco/header";
import { DracoLibrary } from "../../../../client/web/src/stream/draco/library";
import { DracoReader } from "../../../../client/web/src/stream/draco/reader";
import { dracoBlock } from "./draco_block";
import { loadDecoder } from "./draco_modules";
import { hostileBlocks, type HostileBlock } from "./hostile_blocks";

const radii = Float32Array.from({ length: 256 }, (_, code) => 1 + code);
const reader = new DracoReader();
const library = new DracoLibrary(loadDecoder);

/// What a decoder makes of data: positions and radii; null: it is not for this decoder; "refused".
type Outcome = Float32Array | null | "refused";

async function decode(data: Uint8Array, by: "reader" | "library"): Promise<Outcome> {
  try {
    const header = readHeader(data);
    const { points } = header;
    const to = {
      count: points,
      positions: new Float32Array(4 * points),
      normals: new Int8Array(4 * points),
      colours: header.hasColours ? new Uint8Array(4 * points) : null,
    };
    if (by === "library") await library.read(data, radii, to);
    else if (!reader.read(data, header, radii, to)) return null;
    return to.positions;
  } catch (thrown) {
    expect(String(thrown)).toMatch(/bad points/);
    return "refused";
  }
}

describe.each(["reader", "library"] as const)("hostile blocks, for the %s", (by) => {
  let corpus: HostileBlock[] = [];
  beforeAll(async () => {
    corpus = await hostileBlocks();
  });

  it("are refused, or give finite points", async () => {
    let refused = 0;
    for (const { name, data } of corpus) {
      const outcome = await decode(data, by);
      if (outcome === "refused") ++refused;
      else if (outcome !== null && !outcome.every(Number.isFinite)) expect.fail(`${name} gives points that are not finite`);
    }
    expect(corpus.length).toBeGreaterThan(3000);
    expect(refused).toBeGreaterThan(corpus.length / 4);
    const [x, y, z] = (await decode(dracoBlock.data, by)) as Float32Array;
    expect([x, y, z].every((value, axis) => Math.abs(value! - dracoBlock.first[axis]!) < 0.01)).toBe(true); // it stays usable
  });
});

it("both decoders give the same points of a hostile block that both take", async () => {
  let both = 0;
  for (const { name, data } of await hostileBlocks()) {
    const ours = await decode(data, "reader");
    if (ours === null || ours === "refused") continue;
    const theirs = await decode(data, "library");
    if (theirs === null || theirs === "refused") continue;
    ++both;
    if (!ours.every((value, i) => value === theirs[i])) expect.fail(`${name} gives different points`);
  }
  expect(both).toBeGreaterThan(100);
});
