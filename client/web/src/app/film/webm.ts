// SPDX-License-Identifier: Apache-2.0
// Encodes pictures as a film: WebM, by the browser's own encoder.

const codecs = ["vp9", "vp8", "av1"] as const; // the first that the browser has

/// Makes a film of a canvas. Both of its sides are even.
export class WebmWriter {
  private readonly seconds: number; // of a picture
  private written = 0; // pictures

  private constructor(
    private readonly output: { finalize(): Promise<void>; cancel(): Promise<void>; target: { buffer: ArrayBuffer | null } },
    private readonly source: { add(timestamp: number, duration: number): Promise<void> },
    picturesPerSecond: number,
  ) {
    this.seconds = 1 / picturesPerSecond;
  }

  /// Rejects, with the reason in words for the user, where the browser cannot encode.
  static async open(canvas: HTMLCanvasElement, picturesPerSecond: number): Promise<WebmWriter> {
    if (typeof VideoEncoder === "undefined") {
      throw new Error(
        isSecureContext
          ? "This browser has no encoder for films."
          : "Browsers make films only on pages that come over TLS, or from this machine itself.",
      );
    }
    const { BufferTarget, CanvasSource, getFirstEncodableVideoCodec, Output, Quality, WebMOutputFormat } =
      await import("mediabunny");
    const { width, height } = canvas;
    const quality = new Quality("high");
    const codec = await getFirstEncodableVideoCodec([...codecs], { width, height, quality });
    if (codec === null) throw new Error(`This browser cannot encode films of ${width} × ${height} pixels.`);
    const output = new Output({ format: new WebMOutputFormat(), target: new BufferTarget() });
    const source = new CanvasSource(canvas, { codec, quality });
    output.addVideoTrack(source, { frameRate: picturesPerSecond });
    await output.start();
    return new WebmWriter(output, source, picturesPerSecond);
  }

  /// Adds what the canvas shows as the next picture.
  async add(): Promise<void> {
    await this.source.add(this.written * this.seconds, this.seconds);
    ++this.written;
  }

  /// Returns the whole film.
  async finish(): Promise<Blob> {
    await this.output.finalize();
    return new Blob([this.output.target.buffer!], { type: "video/webm" });
  }

  /// Gives the film up.
  async cancel(): Promise<void> {
    await this.output.cancel();
  }
}
