// One call of the service among those that share a socket.

import { create, fromBinary, toBinary, type DescMessage, type MessageInitShape, type MessageShape } from "@bufbuild/protobuf";

import { asCurvecastError, cancelled, CurvecastError } from "./errors";

/// What is sent of a call at once.
export interface CallPart {
  message?: Uint8Array;
  halfClose?: boolean;
  cancel?: boolean;
}

/// Told of a call's responses, in their order, as they come in; `bytes`: of the WebSocket message.
export interface CallHandlers<Output extends DescMessage> {
  onMessage(message: MessageShape<Output>, bytes: number): void;
  /// Once, and nothing after it. null: it ended well.
  onEnd(error: CurvecastError | null): void;
}

/// A call under way. What is sent after its end is dropped: the end tells why.
export class Call<Input extends DescMessage, Output extends DescMessage> {
  private isOver = false;

  constructor(
    private readonly transmit: (part: CallPart) => void,
    private readonly input: Input,
    private readonly output: Output,
    private readonly handlers: CallHandlers<Output>,
  ) {}

  get ended(): boolean {
    return this.isOver;
  }

  /// Sends a request message; `last`: no more follow.
  send(message: MessageInitShape<Input>, last = false): void {
    if (this.isOver) return;
    const bytes = toBinary(this.input, create(this.input, message));
    this.transmit(last ? { message: bytes, halfClose: true } : { message: bytes });
  }

  halfClose(): void {
    if (!this.isOver) this.transmit({ halfClose: true });
  }

  /// Ends the call as CANCELLED, at once.
  cancel(): void {
    if (this.isOver) return;
    this.transmit({ cancel: true });
    this.end(cancelled());
  }

  /// Of the socket: a response message has come.
  receive(message: Uint8Array, bytes: number): void {
    if (this.isOver) return;
    let response: MessageShape<Output>;
    try {
      response = fromBinary(this.output, message);
    } catch (thrown) {
      this.transmit({ cancel: true });
      this.end(new CurvecastError("DATA_LOSS", `the server sent a broken message: ${asCurvecastError(thrown).message}`));
      return;
    }
    this.handlers.onMessage(response, bytes);
  }

  /// Of the socket: the call is over.
  end(error: CurvecastError | null): void {
    if (this.isOver) return;
    this.isOver = true;
    this.handlers.onEnd(error);
  }
}
