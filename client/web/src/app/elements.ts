// SPDX-License-Identifier: Apache-2.0
// Short ways to make elements of the page.

interface Properties {
  class?: string;
  text?: string;
  title?: string;
  attributes?: Readonly<Record<string, string>>;
  onClick?: () => void;
}

/// Makes an element with its children.
export function element<Tag extends keyof HTMLElementTagNameMap>(
  tag: Tag,
  { class: name, text, title, attributes, onClick }: Properties = {},
  children: readonly Node[] = [],
): HTMLElementTagNameMap[Tag] {
  const made = document.createElement(tag);
  if (name !== undefined) made.className = name;
  if (text !== undefined) made.textContent = text;
  if (title !== undefined) made.title = title;
  for (const [attribute, value] of Object.entries(attributes ?? {})) made.setAttribute(attribute, value);
  if (onClick !== undefined) made.addEventListener("click", onClick);
  made.append(...children);
  return made;
}

/// Makes a button with a cross. `what`: what it does.
export function crossButton(what: string, onClick: () => void): HTMLButtonElement {
  const made = button("×", onClick, what);
  made.setAttribute("aria-label", what);
  return made;
}

/// Makes a button that submits no form.
export function button(text: string, onClick: () => void, title?: string): HTMLButtonElement {
  const made = element("button", { text, onClick, ...(title !== undefined && { title }) });
  made.type = "button";
  return made;
}
