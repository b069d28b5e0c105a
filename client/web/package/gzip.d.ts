// SPDX-License-Identifier: Apache-2.0
// A file as package/plugins.mjs puts it into a module.

declare module "*?gzip" {
  const base64: string; // of the compressed bytes
  export default base64;
}
