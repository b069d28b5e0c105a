// SPDX-License-Identifier: Apache-2.0
// The first script of the page: it is small, stands in the page itself, and asks for the poster while the scripts after it come.

import { PageToken } from "./page_token";
import { Poster } from "./poster";

const roomForPanel = 900; // CSS pixels of a window; in a smaller one the panel would cover a part of the picture: see index.html

/// What it leaves to the others.
interface First {
  token: PageToken;
  poster: Poster;
}

declare global {
  interface Window {
    curvecastFirst?: First;
  }
}

function begin(): First {
  const token = PageToken.take();
  document.body.classList.toggle("with-panel", window.innerWidth >= roomForPanel);
  return { token, poster: new Poster(document.querySelector("canvas")!, token.value) };
}

/// Those of the page itself. Where that ran none, as before a bundler has put it there, they are made now.
export const { token, poster } = (window.curvecastFirst ??= begin());
