// Bytes that a server should never send, made from blocks that it might.

import { dracoBlock } from "./draco_block";
import { encodedCloud } from "./draco_modules";

export interface HostileBlock {
  name: string;
  data: Uint8Array<ArrayBuffer>;
}

/// A small generator: the same numbers in every run.
function randomNumbers(seed: number): (below: number) => number {
  let state = seed;
  return (below) => {
    state = (Math.imul(state, 1_664_525) + 1_013_904_223) >>> 0;
    return Math.floor((state / 2 ** 32) * below);
  };
}

function changed(data: Uint8Array, change: (bytes: Uint8Array, view: DataView) => void): Uint8Array<ArrayBuffer> {
  const copy = data.slice();
  change(copy, new DataView(copy.buffer));
  return copy;
}

/// All of a block: cut off, with bytes changed, with numbers at their limits, with noise, with parts twice.
function* variantsOf(name: string, data: Uint8Array): Generator<HostileBlock> {
  const random = randomNumbers(data.length);
  for (let length = 0; length < data.length; length += 3) {
    yield { name: `${name}, ${length} bytes of it`, data: data.slice(0, length) };
  }
  for (let at = 0; at < data.length; ++at) {
    const flip = [1, 0x80, 0xff][at % 3]!;
    yield { name: `${name}, byte ${at} xor ${flip}`, data: changed(data, (bytes) => (bytes[at]! ^= flip)) };
  }
  for (let at = 0; at + 4 <= data.length; at += 2) {
    const limit = [0xffff_ffff, 0x7fff_ffff, 0x8000_0000, 0x7f80_0000][random(4)]!;
    yield { name: `${name}, ${limit} at ${at}`, data: changed(data, (_, view) => view.setUint32(at, limit, true)) };
  }
  for (let i = 0; i < 100; ++i) {
    const [begin, length] = [random(data.length), 1 + random(40)];
    const noise = changed(data, (bytes) => bytes.subarray(begin, begin + length).forEach((_, k, part) => (part[k] = random(256))));
    yield { name: `${name}, noise from ${begin} on`, data: noise };
    const doubled = new Uint8Array([...data.subarray(0, begin + length), ...data.subarray(begin)]);
    yield { name: `${name}, bytes from ${begin} on twice`, data: doubled };
  }
}

/// The corpus: variants of a block of the server, and of clouds with symbols, bits and attributes of every kind.
export async function hostileBlocks(): Promise<HostileBlock[]> {
  const usual = { points: 60, positionBits: 11, normalBits: 7, speed: 5, noise: 0.05, colours: true, others: false };
  const blocks: [string, Uint8Array][] = [
    ["a block of the server", dracoBlock.data],
    ["a cloud with colours", await encodedCloud(usual)],
    ["a cloud with tags", await encodedCloud({ ...usual, positionBits: 24, noise: 3, colours: false })],
    ["a cloud without entropy coding", await encodedCloud({ ...usual, points: 20, speed: 10 })],
    ["a cloud with another attribute", await encodedCloud({ ...usual, others: true })],
  ];
  return blocks.flatMap(([name, data]) => [...variantsOf(name, data)]);
}
