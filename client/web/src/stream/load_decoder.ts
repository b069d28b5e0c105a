// draco3d's WebAssembly, from the page's own server.

import createDecoder from "draco3d/draco_decoder_nodejs.js";
import wasmUrl from "draco3d/draco_decoder.wasm?url";

import { BlockDecoder, type EncodedBlock } from "./block_decoder";
import { badPoints, type DecodedPoints } from "./decoded_points";
import { asCurvecastError, CurvecastError } from "./errors";

async function load(): Promise<BlockDecoder> {
  const response = await fetch(wasmUrl);
  if (!response.ok) throw new CurvecastError("UNAVAILABLE", `the decoder cannot be loaded: HTTP status ${response.status}`);
  return new BlockDecoder(await createDecoder({ wasmBinary: await response.arrayBuffer() }));
}

/// A decoder of this thread that begins to load at once, and again after it could not or has aborted.
export class LoadedDecoder {
  private loading: Promise<void> | null = null;
  private decoder: BlockDecoder | null = null;

  constructor() {
    this.ready().catch(() => {}); // the first block tells
  }

  get isReady(): boolean {
    return this.decoder !== null;
  }

  ready(): Promise<void> {
    this.loading ??= load().then(
      (decoder) => void (this.decoder = decoder),
      (thrown: unknown) => {
        this.loading = null;
        throw asCurvecastError(thrown);
      },
    );
    return this.loading;
  }

  /// Once it is ready. Throws a CurvecastError.
  decode(block: EncodedBlock): DecodedPoints {
    if (this.decoder === null) throw new CurvecastError("INTERNAL", "the decoder is not loaded");
    try {
      return this.decoder.decode(block);
    } catch (thrown) {
      if (thrown instanceof CurvecastError) throw thrown;
      this.decoder = this.loading = null; // the WebAssembly aborted, and cannot be used any more
      this.ready().catch(() => {});
      throw badPoints(asCurvecastError(thrown).message);
    }
  }
}
