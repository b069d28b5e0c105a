// SPDX-License-Identifier: Apache-2.0
// Numbers and faults in words.

import { CurvecastError } from "../stream/errors";

/// Formats a count with separators: 50,000.
export const countText = (value: number): string => value.toLocaleString("en");

/// So many points: 1 point, 50,000 points.
export const pointsText = (value: number): string => `${countText(value)} ${value === 1 ? "point" : "points"}`;

/// Makes the error of a file that cannot be read: what is wrong, and where.
export const badFile = (what: string): CurvecastError => new CurvecastError("INVALID_ARGUMENT", what);
