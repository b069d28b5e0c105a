// One call of the service among those that share a socket.

import { create, fromBinary, toBinary, type DescMessage, type MessageInitShape, type MessageShape } from "@bufbuild/protobuf";

import { asCurvecastError, CurvecastError } from "./errors";

/// What carries the messages of calls; Socket is the one.
export interface CallTransport {
  send(part: { message?: Uint8Array; halfClose?: boolean; cancel?: boolean }): void;
}

/// Told of a call's responses, in their order, as they come in; `bytes`: of the WebSocket message.
export interface CallHandlers<Output extends DescMessage> {
  onMessage(message: MessageShape<Output>, bytes: number): void;
  /// Once, and nothing after it. null: it ended well.
  onEnd(error: CurvecastError | null): void;
}

/// A call under way. What is sent after its end is dropped: the end tells why.
export class Call<Input extends DescMessage, Output extends DescMessage> {
  private over = false;

  constructor(
    private readonly transport: CallTransport,
    private readonly input: Input,
    private readonly output: Output,
    private readonly handlers: CallHandlers<Output>,
  ) {}

  get ended(): boolean {
    return this.over;
  }

  /// Sends a request message; `last`: no more follow.
  send(message: MessageInitShape<Input>, last = false): void {
    if (this.over) return;
    const bytes = toBinary(this.input, create(this.input, message));
    this.transport.send(last ? { message: bytes, halfClose: true } : { message: bytes });
  }

  halfClose(): void {
    if (!this.over) this.transport.send({ halfClose: true });
  }

  /// Ends the call as CANCELLED, at once.
  cancel(): void {
    if (this.over) return;
    this.transport.send({ cancel: true });
    this.end(new CurvecastError("CANCELLED", "cancelled"));
  }

  /// Of the transport: a response message has come.
  take(message: Uint8Array, bytes: number): void {
    if (this.over) return;
    let response: MessageShape<Output>;
    try {
      response = fromBinary(this.output, message);
    } catch (thrown) {
      this.transport.send({ cancel: true });
      this.end(new CurvecastError("DATA_LOSS", `the server sent a broken message: ${asCurvecastError(thrown).message}`));
      return;
    }
    this.handlers.onMessage(response, bytes);
  }

  /// Of the transport: the call is over.
  end(error: CurvecastError | null): void {
    if (this.over) return;
    this.over = true;
    this.handlers.onEnd(error);
  }
}
