// SPDX-License-Identifier: Apache-2.0
// Errors of calls, in the terms of gRPC.

import { fromBinary } from "@bufbuild/protobuf";

import { RetryInfoSchema, type Status } from "../gen/curvecast/v1/status_pb";

const names = [
  "OK",
  "CANCELLED",
  "UNKNOWN",
  "INVALID_ARGUMENT",
  "DEADLINE_EXCEEDED",
  "NOT_FOUND",
  "ALREADY_EXISTS",
  "PERMISSION_DENIED",
  "RESOURCE_EXHAUSTED",
  "FAILED_PRECONDITION",
  "ABORTED",
  "OUT_OF_RANGE",
  "UNIMPLEMENTED",
  "INTERNAL",
  "UNAVAILABLE",
  "DATA_LOSS",
  "UNAUTHENTICATED",
] as const;

/// The name of a gRPC status code.
export type ErrorCode = (typeof names)[number];

const retryInfo = "google.rpc.RetryInfo";
const maxSeconds = 3600;

/// The error of a call that failed. `message` is the server's: what was wrong, where, and what to do.
export class CurvecastError extends Error {
  /// `retryAfter`: seconds after which the server asks to try again; null where the server does not say.
  constructor(
    readonly code: ErrorCode,
    message: string,
    readonly retryAfter: number | null = null,
  ) {
    super(message);
    this.name = "CurvecastError";
  }
}

/// Names a status code of the wire. A code that is not known, or that stands for no error, is UNKNOWN.
export function codeName(code: number): ErrorCode {
  return code === 0 ? "UNKNOWN" : (names[code] ?? "UNKNOWN");
}

/// Bounds the seconds that a server asks to wait by an hour. Returns null where the server asks for none.
export function boundedDelay(seconds: number): number | null {
  return seconds > 0 ? Math.min(seconds, maxSeconds) : null;
}

/// Returns the error that a call ended with; null where the call ended well.
export function errorOf(status: Status): CurvecastError | null {
  return status.code === 0 ? null : new CurvecastError(codeName(status.code), status.message, retryAfterOf(status));
}

/// Makes the error of a call that its caller has cancelled.
export function cancelled(): CurvecastError {
  return new CurvecastError("CANCELLED", "cancelled");
}

/// Turns anything that was thrown into a CurvecastError.
export function asCurvecastError(thrown: unknown): CurvecastError {
  if (thrown instanceof CurvecastError) return thrown;
  if (thrown instanceof DOMException && thrown.name === "AbortError") return cancelled();
  return new CurvecastError("UNKNOWN", thrown instanceof Error ? thrown.message : String(thrown));
}

function retryAfterOf(status: Status): number | null {
  const detail = status.details.find((any) => any.typeUrl.endsWith(`/${retryInfo}`));
  if (detail === undefined) return null;
  try {
    const delay = fromBinary(RetryInfoSchema, detail.value).retryDelay;
    return delay === undefined ? null : boundedDelay(Number(delay.seconds) + delay.nanos / 1e9);
  } catch {
    return null; // the error itself matters more than when to try again
  }
}
