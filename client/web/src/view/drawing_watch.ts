// When the graphics card, or the processor in its place, has drawn what it was given.

const betweenLooks = 4; // ms

export class DrawingWatch {
  private sync: WebGLSync | null = null;

  constructor(
    private readonly gl: WebGL2RenderingContext,
    private readonly onDrawn: () => void,
  ) {}

  get isDrawing(): boolean {
    return this.sync !== null;
  }

  /// All that has been asked for so far is watched.
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
    // Of a context that was lost there is no status.
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
