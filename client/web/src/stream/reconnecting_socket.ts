// The socket of a client, made anew after it was lost.

import { CurvecastError } from "./errors";
import { Socket, defaultIdleTimeout, type Endpoint } from "./socket";

const maxIdleTimeout = 120; // seconds

/// Has a socket while one is wanted, and makes another after it was lost.
export class ReconnectingSocket {
  private current: Socket | null = null;
  private idleTimeout = defaultIdleTimeout;
  private isClosed = false;

  constructor(private readonly endpoint: Endpoint) {}

  /// Open, or on its way there. Throws as checkOpen().
  socket(): Socket {
    this.checkOpen();
    if (this.current === null || this.current.error !== null) {
      // A large message on a slow line looks like a dead one, until all of it is there: the next socket gets more time.
      this.idleTimeout = this.current?.timedOut === true ? Math.min(2 * this.idleTimeout, maxIdleTimeout) : defaultIdleTimeout;
      this.current = new Socket(this.endpoint, this.idleTimeout);
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
