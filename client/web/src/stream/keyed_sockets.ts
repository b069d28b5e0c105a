// SPDX-License-Identifier: Apache-2.0
// The sockets of a client, by what its calls are about.

import { CurvecastError } from "./errors";
import { ReconnectingSocket } from "./reconnecting_socket";
import type { Endpoint, Socket } from "./socket";

const keyDigits = 16; // those of a session are those of its mesh

/// The address that names what calls are about, the mesh or the session `id`; empty: nothing.
export function keyedEndpoint(endpoint: Endpoint, id: string): Endpoint {
  if (id === "") return endpoint;
  const { url } = endpoint;
  return { ...endpoint, url: `${url}${url.includes("?") ? "&" : "?"}key=${encodeURIComponent(id.slice(0, keyDigits))}` };
}

/// One socket for all calls about a mesh, whose address names it: a proxy in front of several servers may choose one by that. Nobody
/// has to: every server can answer every call.
export class KeyedSockets {
  private readonly sockets = new Map<string, ReconnectingSocket>(); // the last one asked for at the end
  private isClosed = false;

  constructor(private readonly endpoint: Endpoint) {}

  /// Returns a socket that is open or opening, for calls about the mesh or the session `id`; without it for calls about none, which go
  /// where the last one went. Throws CANCELLED after close().
  socket(id?: string): Socket {
    this.checkOpen();
    const key = id?.slice(0, keyDigits) ?? [...this.sockets.keys()].at(-1) ?? "";
    const found = this.sockets.get(key) ?? this.open(key);
    this.sockets.delete(key);
    this.sockets.set(key, found);
    return found.socket();
  }

  /// Throws CANCELLED after close().
  checkOpen(): void {
    if (this.isClosed) throw new CurvecastError("CANCELLED", "the client was closed");
  }

  /// Ends all calls, and lets no other socket be opened.
  close(): void {
    this.isClosed = true;
    for (const socket of this.sockets.values()) socket.close();
  }

  /// Closes the others that nobody uses any more.
  private open(key: string): ReconnectingSocket {
    for (const [other, socket] of this.sockets) {
      if (!socket.isIdle) continue;
      socket.close();
      this.sockets.delete(other);
    }
    return new ReconnectingSocket(keyedEndpoint(this.endpoint, key));
  }
}
