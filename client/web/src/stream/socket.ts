// SPDX-License-Identifier: Apache-2.0
// The WebSocket that carries the API, with any number of calls at once. See web_socket.proto.

import {
  create,
  fromBinary,
  toBinary,
  type DescMessage,
  type DescMethod,
  type DescMethodServerStreaming,
  type DescMethodUnary,
  type MessageInitShape,
  type MessageShape,
} from "@bufbuild/protobuf";

import { CurvecastService } from "../gen/curvecast/v1/curvecast_pb";
import { CallRequestSchema, CallResponseSchema, type CallResponse } from "../gen/curvecast/v1/web_socket_pb";
import { Call, type CallHandlers, type CallPart } from "./call";
import { cancelled, CurvecastError, errorOf } from "./errors";
import { LivenessMonitor } from "./liveness";

/// Where a server is, and who asks.
export interface Endpoint {
  url: string; // ws: or wss:
  token?: string | undefined; // bearer token
  webSocket?: (url: string, protocols: string[]) => WebSocket; // makes the socket, for tests and where there is no browser; default: the browser's
}

/// Seconds without a sign of life before the server is asked for one.
export const defaultIdleTimeout = 15;

const maxBuffered = 4 << 20; // bytes; while more wait in the browser, an upload pauses
const secondsBetweenLooks = 0.01; // at the bytes that still wait: browsers have no event for that

/// Makes the address of a server's socket. `base`: URL or path below which the server's pages are.
export function socketUrl(base: string): string {
  const url = new URL("v1/socket", new URL(base, (globalThis as { location?: Location }).location?.href));
  url.protocol = url.protocol === "https:" || url.protocol === "wss:" ? "wss:" : "ws:";
  url.hash = url.search = "";
  return url.href;
}

function subprotocols(token: string | undefined): string[] {
  if (token === undefined || token === "") return ["curvecast.v1"];
  const bytes = Array.from(new TextEncoder().encode(token), (byte) => String.fromCharCode(byte)).join("");
  return ["curvecast.v1", "curvecast.bearer." + btoa(bytes).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "")];
}

/// Makes the error of the calls on a socket that was closed. Browsers hide an HTTP answer that refused a socket behind code 1006.
function errorOfClose(code: number, reason: string, wasOpen: boolean): CurvecastError {
  switch (code) {
    case 1001:
      return new CurvecastError("UNAVAILABLE", reason || "the server shuts down");
    case 1007:
      return new CurvecastError("INTERNAL", reason || "the server did not understand a message");
    case 1008:
      return new CurvecastError("UNAUTHENTICATED", reason || "the server does not take this caller");
    case 1009:
      return new CurvecastError("INVALID_ARGUMENT", reason || "a message was too large for the server");
    default:
      return new CurvecastError(
        "UNAVAILABLE",
        reason || (wasOpen ? "the connection to the server was lost" : "the server cannot be reached"),
      );
  }
}

/// Opens a WebSocket at once. Calls may be made before it is open. Once it is lost or closed, all calls end with an error. A socket is
/// lost, too, where the server gives no sign of life for `idleTimeout` seconds and then does not answer a probe: UNAVAILABLE.
export class Socket {
  timedOut = false; // the socket was open, and was lost because the server did not answer any more

  private readonly socket: WebSocket;
  private readonly calls = new Map<number, Call<DescMessage, DescMessage>>();
  private early: Uint8Array[] | null = []; // messages that wait until the socket is open; null from then on
  private sentBytes = 0; // so far, with those that still wait
  private lastCall = 0;
  private failure: CurvecastError | null = null;
  private readonly liveness: LivenessMonitor; // runs while there are calls

  constructor(endpoint: Endpoint, idleTimeout = defaultIdleTimeout) {
    const make = endpoint.webSocket ?? ((url, protocols) => new WebSocket(url, protocols));
    this.socket = make(endpoint.url, subprotocols(endpoint.token));
    this.socket.binaryType = "arraybuffer";
    this.liveness = new LivenessMonitor(
      {
        bytes: () => ({ sent: this.sentBytes, waiting: this.bufferedBytes }),
        probe: () => this.probe(),
        dead: () => this.giveUp(),
      },
      idleTimeout,
    );
    this.socket.onopen = () => this.flush();
    this.socket.onmessage = (event: MessageEvent<unknown>) => this.receive(event.data);
    this.socket.onclose = (event) => this.fail(errorOfClose(event.code, event.reason, this.early === null));
  }

  /// Why no call can be made any more; null while calls can be made.
  get error(): CurvecastError | null {
    return this.failure;
  }

  /// No call runs on it.
  get isIdle(): boolean {
    return this.calls.size === 0;
  }

  /// Bytes that were sent and still wait in the page or in the browser.
  get bufferedBytes(): number {
    return this.socket.bufferedAmount + (this.early ?? []).reduce((sum, bytes) => sum + bytes.length, 0);
  }

  /// Resolves when few bytes wait to leave, or when the socket is lost. Rejects with CANCELLED once `signal` is aborted.
  async drained(signal?: AbortSignal): Promise<void> {
    while (this.failure === null && this.bufferedBytes > maxBuffered) {
      if (signal?.aborted) throw cancelled();
      await new Promise((resolve) => setTimeout(resolve, 1000 * secondsBetweenLooks));
    }
    if (signal?.aborted) throw cancelled();
  }

  /// Begins a call of any kind.
  start<Input extends DescMessage, Output extends DescMessage>(
    method: DescMethod & { input: Input; output: Output },
    handlers: CallHandlers<Output>,
  ): Call<Input, Output> {
    const number = ++this.lastCall;
    let name: string | undefined = method.name;
    const transmit = (part: CallPart) => {
      if (part.cancel === true) this.forget(number);
      if (name !== undefined && part.cancel === true) return; // the server does not know the call
      this.transmit(
        toBinary(
          CallRequestSchema,
          create(CallRequestSchema, { call: number, ...(name !== undefined && { method: name }), ...part }),
        ),
      );
      name = undefined;
    };
    const call = new Call(transmit, method.input, method.output, {
      onMessage: handlers.onMessage.bind(handlers),
      onEnd: handlers.onEnd.bind(handlers),
    });
    const failure = this.failure;
    if (failure !== null) {
      queueMicrotask(() => call.end(failure));
    } else {
      this.calls.set(number, call);
      this.liveness.start();
    }
    return call;
  }

  /// Sends one request, and resolves with the response.
  async unary<Input extends DescMessage, Output extends DescMessage>(
    method: DescMethodUnary<Input, Output>,
    request: MessageInitShape<Input>,
    signal?: AbortSignal,
  ): Promise<MessageShape<Output>> {
    const responses: MessageShape<Output>[] = [];
    await this.run(method, request, (message) => responses.push(message), signal);
    const last = responses.at(-1);
    if (last === undefined) throw new CurvecastError("INTERNAL", `${method.name} ended without a response`);
    return last;
  }

  /// Sends one request, and yields the responses. Leaving the loop cancels the call.
  async *serverStream<Input extends DescMessage, Output extends DescMessage>(
    method: DescMethodServerStreaming<Input, Output>,
    request: MessageInitShape<Input>,
    signal?: AbortSignal,
  ): AsyncGenerator<MessageShape<Output>, void, undefined> {
    const waiting: MessageShape<Output>[] = [];
    let wake = () => {};
    const call = { isOver: false };
    const leave = new AbortController();
    const abort = () => leave.abort(); // without AbortSignal.any(), which is too new for some browsers
    signal?.addEventListener("abort", abort, { once: true });
    if (signal?.aborted) abort();
    const ended = this.run(method, request, (message) => (waiting.push(message), wake()), leave.signal).finally(() => {
      call.isOver = true;
      wake();
    });
    ended.catch(() => {}); // awaited below
    try {
      while (true) {
        for (let message = waiting.shift(); message !== undefined; message = waiting.shift()) yield message;
        if (call.isOver) break;
        await new Promise<void>((resolve) => (wake = resolve));
      }
      await ended;
    } finally {
      signal?.removeEventListener("abort", abort);
      abort();
    }
  }

  /// Closes the socket. All calls end as CANCELLED.
  close(): void {
    this.socket.close(1000);
    this.fail(new CurvecastError("CANCELLED", "the connection was closed"));
  }

  private run<Input extends DescMessage, Output extends DescMessage>(
    method: DescMethod & { input: Input; output: Output },
    request: MessageInitShape<Input>,
    onMessage: (message: MessageShape<Output>) => void,
    signal: AbortSignal | undefined,
  ): Promise<void> {
    return new Promise((resolve, reject) => {
      if (signal?.aborted) return reject(cancelled());
      const abort = () => call.cancel();
      const call = this.start(method, {
        onMessage,
        onEnd: (error) => {
          signal?.removeEventListener("abort", abort);
          if (error === null) resolve();
          else reject(error);
        },
      });
      signal?.addEventListener("abort", abort, { once: true });
      call.send(request, true);
    });
  }

  private transmit(bytes: Uint8Array): void {
    if (this.failure !== null) return;
    this.sentBytes += bytes.length;
    if (this.early !== null) this.early.push(bytes);
    else this.socket.send(bytes);
  }

  private flush(): void {
    const early = this.early ?? [];
    this.early = null;
    this.liveness.heard();
    for (const bytes of early) this.socket.send(bytes);
  }

  /// Asks for a sign of life. Any answer is one; this is the cheapest.
  private probe(): void {
    if (this.early === null) this.unary(CurvecastService.method.listSessions, { pageSize: 1 }).catch(() => {});
  }

  private giveUp(): void {
    const wasOpen = this.early === null;
    this.timedOut = wasOpen;
    this.socket.close(4001, "the server does not answer");
    this.fail(new CurvecastError("UNAVAILABLE", wasOpen ? "the server does not answer" : "the server cannot be reached"));
  }

  private receive(data: unknown): void {
    this.liveness.heard();
    let response: CallResponse;
    try {
      if (!(data instanceof ArrayBuffer)) throw new CurvecastError("INTERNAL", "not binary");
      response = fromBinary(CallResponseSchema, new Uint8Array(data));
    } catch {
      this.socket.close(4000, "a message that is none");
      return this.fail(new CurvecastError("DATA_LOSS", "the server sent a message that is none"));
    }
    const call = this.calls.get(response.call);
    if (call === undefined) return; // the call was cancelled meanwhile
    if (response.message !== undefined) call.receive(response.message, data.byteLength);
    if (response.status === undefined) return;
    this.forget(response.call);
    call.end(errorOf(response.status));
  }

  /// Drops a call that is over.
  private forget(call: number): void {
    this.calls.delete(call);
    if (this.calls.size === 0) this.liveness.stop();
  }

  private fail(error: CurvecastError): void {
    if (this.failure !== null) return;
    this.failure = error;
    this.liveness.stop();
    const calls = [...this.calls.values()];
    this.calls.clear();
    for (const call of calls) call.end(error);
  }
}
