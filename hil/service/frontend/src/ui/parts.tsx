// Small parts that every view is made of.

import type { ComponentChildren, JSX } from "preact";
import { useState } from "preact/hooks";
import { exactMoment, moment } from "../format.ts";
import { English } from "../i18n/english.tsx";
import { placeOf, titleOf } from "../addresses.ts";
import type { Asked } from "../data.ts";
import { kindInWords } from "./kinds.ts";

export { inWords } from "./kinds.ts";
export { verdictOf } from "./run-kind.ts";
import { t } from "../i18n/text.ts";

export function Badge({ kind }: { kind: string }): JSX.Element {
  return <span class={`verdict ${kind}`}>{kindInWords(kind)}</span>;
}

// A moment in the reader's language, `exact` to the second; as ISO 8601 where the pointer stays on it.
export function Moment({ at, exact = false }: { at: string | null | undefined; exact?: boolean }): JSX.Element {
  return at ? <time dateTime={at} title={at}>{exact ? exactMoment(at) : moment(at)}</time> : <span>–</span>;
}

export function Heading({ kind, children }: { kind?: ComponentChildren; children: ComponentChildren }): JSX.Element {
  return (
    <div class="heading">
      {kind ? <p class="kind">{kind}</p> : null}
      <h1>{children}</h1>
    </div>
  );
}

export function Section({ title, aside, children, label }: { title: ComponentChildren; aside?: ComponentChildren; children: ComponentChildren; label: string }): JSX.Element {
  const id = `section-${label}`;
  return (
    <section class="part" aria-labelledby={id}>
      <div class="part-head"><h2 id={id}>{title}</h2>{aside}</div>
      {children}
    </section>
  );
}

// A link around words of a translated sentence: see `tx`.
export const linkTo = (href: string) => (words: ComponentChildren): JSX.Element => <a href={href}>{words}</a>;

// A table that scrolls by itself where it is wider than the page.
export function Scroll({ label, children }: { label: string; children: ComponentChildren }): JSX.Element {
  return <div class="scroll" tabIndex={0} role="region" aria-label={t("{label}, table", { label })}>{children}</div>;
}

// What was asked for, or why it is not there; a whole view has a heading then, too.
export function Loaded<T>({ of, children, what, whole = false }: { of: Asked<T>; what: string; whole?: boolean; children: (data: T) => ComponentChildren }): JSX.Element {
  if (of.data !== null) return <>{children(of.data)}</>;
  if (of.error) return <>{whole ? <Heading>{titleOf(placeOf(location.pathname))}</Heading> : null}<p class="bad" role="alert"><English>{of.error.message}</English></p></>;
  return <p class="quiet">{t("Loading {what} …", { what })}</p>;
}

const FOLDED_LETTERS = 500, FOLDED_LINES = 8;

// A text of a person: the beginning of a long one, and the rest when somebody asks for it.
export function Written({ children }: { children: string }): JSX.Element {
  const isLong = children.length > FOLDED_LETTERS || children.split("\n").length > FOLDED_LINES, [open, setOpen] = useState(false);
  return (
    <>
      <p class={isLong && !open ? "written folded" : "written"}>{children}</p>
      {isLong ? <button type="button" class="plain" aria-expanded={open} onClick={() => setOpen(!open)}>{open ? t("Show less") : t("Show all of it")}</button> : null}
    </>
  );
}

const SHOWN = /\.(html|pdf|json|xml|txt|yaml|toml|csv|svg|png)$/;

// A file of the service: what a browser shows comes beside the page, anything else is downloaded.
export function FileLink({ href, name, children }: { href: string; name: string; children: ComponentChildren }): JSX.Element {
  return SHOWN.test(name) ? <a href={href} target="_blank" rel="noopener">{children}</a> : <a href={href} download>{children}</a>;
}

export function Facts({ children }: { children: [ComponentChildren, ComponentChildren][] }): JSX.Element {
  return (
    <dl class="facts">
      {children.map(([name, value], at) => <div key={at}><dt>{name}</dt><dd>{value}</dd></div>)}
    </dl>
  );
}
