// SPDX-License-Identifier: Apache-2.0
// A call of the service, one of those that share a socket.

import { create, fromBinary, toBinary, type DescMessage, type MessageInitShape, type MessageShape } from "@bufbuild/protobuf";

import { asCurvecastError, cancelled, CurvecastError } from "./errors";

/// A part of a call that is sent in one WebSocket message.
export interface CallPart {
  message?: Uint8Array;
  halfClose?: boolean;
  cancel?: boolean;
}

/// Takes the responses of a call, in their order.
export interface CallHandlers<Output extends DescMessage> {
  /// A response has come. `bytes`: size of its WebSocket message.
  onMessage(message: MessageShape<Output>, bytes: number): void;
  /// The call has ended, well where `error` is null. Nothing is called after it.
  onEnd(error: CurvecastError | null): void;
}

/// A call under way. Messages that are sent after its end are dropped: onEnd() has said why it ended.
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

  /// Sends a request message. `last`: no other follows.
  send(message: MessageInitShape<Input>, last = false): void {
    if (this.isOver) return;
    const bytes = toBinary(this.input, create(this.input, message));
    this.transmit(last ? { message: bytes, halfClose: true } : { message: bytes });
  }

  halfClose(): void {
    if (!this.isOver) this.transmit({ halfClose: true });
  }

  /// Ends the call at once, as CANCELLED.
  cancel(): void {
    if (this.isOver) return;
    this.transmit({ cancel: true });
    this.end(cancelled());
  }

  /// Takes a response message from the socket. `bytes`: size of its WebSocket message.
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

  /// Takes the end of the call from the socket.
  end(error: CurvecastError | null): void {
    if (this.isOver) return;
    this.isOver = true;
    this.handlers.onEnd(error);
  }
}
