// One socket after the other.

import { CurvecastError } from "./errors";
import { Socket, usualPatience, type Endpoint } from "./socket";

const mostPatience = 120; // seconds

/// Has a socket while one is wanted, and makes another after it was lost.
export class Line {
  private current: Socket | null = null;
  private patience = usualPatience;
  private isClosed = false;

  constructor(private readonly endpoint: Endpoint) {}

  /// Open, or on its way there. Throws as checkOpen().
  socket(): Socket {
    this.checkOpen();
    if (this.current === null || this.current.error !== null) {
      // A large message on a slow line is silence too, until all of it is there: the next socket gets more time.
      this.patience = this.current?.fellSilent === true ? Math.min(2 * this.patience, mostPatience) : usualPatience;
      this.current = new Socket(this.endpoint, this.patience);
    }
    return this.current;
  }

  /// Throws CANCELLED after close().
  checkOpen(): void {
    if (this.isClosed) throw new CurvecastError("CANCELLED", "the client was closed");
  }

  /// Ends all calls.
  close(): void {
    this.isClosed = true;
    this.current?.close();
  }
}
