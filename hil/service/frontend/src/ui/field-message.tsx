// What keeps a form back stands at its field, in the page's language: in place of the browser's own bubble.

import type { JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import { Store, useStore } from "../store.ts";
import { whyInvalid } from "./why-invalid.ts";

type Control = HTMLInputElement | HTMLSelectElement | HTMLTextAreaElement;

const kept = new Store<{ field: Control; why: string } | null>(null);
const ID = "field-message", WIDEST_PX = 320, EDGE_PX = 16, BELOW_PX = 4;

let isFirst = true; // of the fields of one form, which the browser names one after the other

addEventListener("invalid", (event) => {
  event.preventDefault();
  if (!isFirst) return;
  isFirst = false;
  setTimeout(() => { isFirst = true; });
  const field = event.target as Control, why = whyInvalid(field);
  field.focus();
  kept.value = isSaid(field, why) ? null : { field, why };
}, true);

// Some fields say it by themselves while somebody types.
const isSaid = (field: Control, why: string): boolean => [...(field.closest("form")?.querySelectorAll("[role=alert]") ?? [])].some((one) => one.textContent === why);

export function FieldMessage(): JSX.Element | null {
  const one = useStore(kept), shown = useRef<HTMLParagraphElement>(null);
  useEffect(() => {
    if (!one) return undefined;
    const { field } = one, described = field.getAttribute("aria-describedby"), clear = () => { kept.value = null; };
    field.setAttribute("aria-describedby", described ? `${described} ${ID}` : ID);
    for (const name of ["input", "change", "blur"]) field.addEventListener(name, clear);
    addEventListener("resize", clear);
    shown.current?.scrollIntoView({ block: "nearest" });
    return () => {
      if (described) field.setAttribute("aria-describedby", described); else field.removeAttribute("aria-describedby");
      for (const name of ["input", "change", "blur"]) field.removeEventListener(name, clear);
      removeEventListener("resize", clear);
    };
  }, [one]);
  if (!one) return null;
  const box = one.field.getBoundingClientRect();
  const left = Math.max(EDGE_PX, Math.min(box.left, document.documentElement.clientWidth - EDGE_PX - WIDEST_PX));
  return <p id={ID} ref={shown} class="field-message" role="alert" style={{ left: `${left + scrollX}px`, top: `${box.bottom + scrollY + BELOW_PX}px` }}>{one.why}</p>;
}
