// SPDX-License-Identifier: Apache-2.0
// Notices when the graphics card, or the processor in its stead, has drawn what it was given.

const betweenLooks = 4; // ms

/// Watches the commands of a context. Calls `onDrawn` once all watched commands are done.
export class DrawingWatch {
  private sync: WebGLSync | null = null;

  constructor(
    private readonly gl: WebGL2RenderingContext,
    private readonly onDrawn: () => void,
  ) {}

  get isDrawing(): boolean {
    return this.sync !== null;
  }

  /// Watches all commands that were given so far, instead of those watched before.
  begin(): void {
    const isWatching = this.isDrawing;
    this.gl.deleteSync(this.sync);
    this.sync = this.gl.fenceSync(this.gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    this.gl.flush();
    if (this.isDrawing && !isWatching) setTimeout(() => this.look(), betweenLooks);
  }

  private look(): void {
    const { gl, sync } = this;
    if (sync === null) return;
    // A context that was lost has no status.
    const isOver = gl.isContextLost() || gl.getSyncParameter(sync, gl.SYNC_STATUS) !== gl.UNSIGNALED;
    if (!isOver) {
      setTimeout(() => this.look(), betweenLooks);
      return;
    }
    gl.deleteSync(sync);
    this.sync = null;
    this.onDrawn();
  }
}
