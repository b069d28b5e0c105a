// SPDX-License-Identifier: Apache-2.0
// The socket of a client, made anew after it was lost.

import { CurvecastError } from "./errors";
import { Socket, defaultIdleTimeout, type Endpoint } from "./socket";

const maxIdleTimeout = 120; // seconds

/// Opens a socket when it is needed, and another after that one was lost.
export class ReconnectingSocket {
  private current: Socket | null = null;
  private idleTimeout = defaultIdleTimeout;
  private isClosed = false;

  constructor(private readonly endpoint: Endpoint) {}

  /// Returns a socket that is open or opening. Throws CANCELLED after close().
  socket(): Socket {
    this.checkOpen();
    if (this.current === null || this.current.error !== null) {
      // A large message on a slow line comes without a sign of life until all of it is there: the next socket gets more time.
      this.idleTimeout = this.current?.timedOut === true ? Math.min(2 * this.idleTimeout, maxIdleTimeout) : defaultIdleTimeout;
      this.current = new Socket(this.endpoint, this.idleTimeout);
    }
    return this.current;
  }

  /// No call runs on it.
  get isIdle(): boolean {
    return this.current === null || this.current.isIdle;
  }

  /// Throws CANCELLED after close().
  checkOpen(): void {
    if (this.isClosed) throw new CurvecastError("CANCELLED", "the client was closed");
  }

  /// Ends all calls, and lets no other socket be opened.
  close(): void {
    this.isClosed = true;
    this.current?.close();
  }
}
