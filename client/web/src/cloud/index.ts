// SPDX-License-Identifier: Apache-2.0
// Point clouds from the user's own files, read in the browser alone.

export { cloudAmong } from "./cloud_files";
export { CloudStore, type Cloud } from "./cloud_store";
export { openCloud, type CloudOptions } from "./open_cloud";
