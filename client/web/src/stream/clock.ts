// SPDX-License-Identifier: Apache-2.0
/// Returns seconds of a clock that never goes back.
export const now = (): number => performance.now() / 1000;
