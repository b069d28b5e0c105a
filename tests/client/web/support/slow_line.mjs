// A slow line to a server: a proxy that lets through so many bits a second each way, all connections together, and each byte so
// late. What a sender sends beyond that waits in the line, however much it is, and is counted.

import { createServer, connect } from "node:net";

/// One direction: chunks of all connections, one after the other.
class Lane {
  constructor(bytesPerSecond, delay) {
    this.bytesPerSecond = bytesPerSecond;
    this.delay = delay; // milliseconds
    this.freeAt = 0; // when all that was sent so far is through
    this.waiting = []; // deliveries
    this.passed = 0; // bytes
    this.mostWaiting = 0; // bytes
  }

  /// Calls deliver(part) for the parts of a chunk when the line has brought them.
  send(chunk, deliver) {
    const now = performance.now();
    this.freeAt = Math.max(this.freeAt, now);
    const size = 1460; // of a packet
    for (let at = 0; at < chunk.length; at += size) {
      const part = chunk.subarray(at, at + size);
      this.freeAt += (1000 * part.length) / this.bytesPerSecond;
      this.waiting.push(() => deliver(part));
      setTimeout(() => this.waiting.shift()(), this.freeAt + this.delay - now); // in their order, whichever timer is first
    }
    this.passed += chunk.length;
    this.mostWaiting = Math.max(this.mostWaiting, ((this.freeAt - now) * this.bytesPerSecond) / 1000);
  }
}

export class SlowLine {
  /// To a server on this machine. `roundTrip`: milliseconds.
  static async start(port, bitsPerSecond, roundTrip) {
    const line = new SlowLine();
    line.up = new Lane(bitsPerSecond / 8, roundTrip / 2);
    line.down = new Lane(bitsPerSecond / 8, roundTrip / 2);
    line.listener = createServer((client) => {
      // A connection is there after a round trip.
      const server = connect({ port, host: "127.0.0.1", noDelay: true });
      client.setNoDelay(true);
      const readyAt = performance.now() + roundTrip;
      const join = (from, to, lane) => {
        from.on("data", (chunk) => {
          const early = lane === line.up ? Math.max(0, readyAt - performance.now()) : 0;
          setTimeout(() => lane.send(chunk, (part) => to.writable && to.write(part)), early);
        });
        from.on("end", () => setTimeout(() => to.end(), roundTrip));
        from.on("error", () => to.destroy());
      };
      join(client, server, line.up);
      join(server, client, line.down);
    });
    await new Promise((resolve) => line.listener.listen(0, "127.0.0.1", resolve));
    line.port = line.listener.address().port;
    return line;
  }

  stop() {
    this.listener.close();
  }
}
