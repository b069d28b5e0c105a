// The server's end of a WebSocket, for tests.

import { create, fromBinary, toBinary, type DescMessage, type MessageInitShape, type MessageShape } from "@bufbuild/protobuf";

import { CallRequestSchema, CallResponseSchema, type CallRequest } from "../../../../client/web/src/gen/curvecast/v1/web_socket_pb";

export class FakeWebSocket {
  static made: FakeWebSocket[] = [];
  binaryType = "blob";
  bufferedAmount = 0;
  onopen: (() => void) | null = null;
  onmessage: ((event: { data: unknown }) => void) | null = null;
  onclose: ((event: { code: number; reason: string }) => void) | null = null;
  readonly requests: CallRequest[] = [];
  isClosed = false;

  constructor(
    readonly url: string,
    readonly protocols: string[],
  ) {
    FakeWebSocket.made.push(this);
  }

  static make = (url: string, protocols: string[]) => new FakeWebSocket(url, protocols) as unknown as WebSocket;

  send(bytes: Uint8Array): void {
    if (this.isClosed) throw new Error("it is closed");
    this.requests.push(fromBinary(CallRequestSchema, bytes));
  }

  close(code = 1000, reason = ""): void {
    if (this.isClosed) return;
    this.isClosed = true;
    queueMicrotask(() => this.onclose?.({ code, reason }));
  }

  open(): this {
    this.onopen?.();
    return this;
  }

  /// What came with a call, decoded; those without a message left out.
  sent<Desc extends DescMessage>(schema: Desc, call = 1): MessageShape<Desc>[] {
    return this.requests.flatMap((request) =>
      request.call === call && request.message !== undefined ? [fromBinary(schema, request.message)] : [],
    );
  }

  respond<Desc extends DescMessage>(schema: Desc, message: MessageInitShape<Desc>, call = 1): void {
    this.deliver({ call, message: toBinary(schema, create(schema, message)) });
  }

  end(call = 1, status: { code?: number; message?: string; details?: { typeUrl: string; value: Uint8Array }[] } = {}): void {
    this.deliver({ call, status });
  }

  /// The server, or the network, closes it.
  lose(code: number, reason = ""): void {
    this.isClosed = true;
    this.onclose?.({ code, reason });
  }

  private deliver(response: MessageInitShape<typeof CallResponseSchema>): void {
    const bytes = toBinary(CallResponseSchema, create(CallResponseSchema, response));
    this.onmessage?.({ data: bytes.slice().buffer });
  }
}

/// After all that waits for promises has run.
export function settle(milliseconds = 0): Promise<void> {
  return new Promise((resolve) => setTimeout(resolve, milliseconds));
}

/// Waits for what happens in its own time; a test that waits in vain runs into its limit.
export async function until(happened: () => boolean): Promise<void> {
  while (!happened()) await settle(1);
}
