// A session of the page is opened with a token; the cookie is not the token, and scripts cannot read it.

import type { JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import { ask } from "../api/client.ts";
import { attempt } from "../data.ts";
import { t } from "../i18n/text.ts";
import { lookWho, session } from "../session.ts";

export function SignIn(): JSX.Element {
  const secret = useRef<HTMLInputElement>(null);
  useEffect(() => secret.current?.focus(), []);
  const submit = async (event: Event) => {
    event.preventDefault();
    const opened = await attempt(async () => { await ask("POST", "/session", { secret: secret.current?.value ?? "" }); return true; });
    if (opened) await lookWho();
  };
  return (
    <form class="card narrow" onSubmit={(event) => void submit(event)}>
      <h1>{t("Sign in")}</h1>
      <label class="field">{t("Token")} <input ref={secret} type="password" autocomplete="current-password" required maxLength={200} /></label>
      <button type="submit" class="main">{t("Sign in")}</button>
      <p class="quiet">{t("An administrator makes tokens. The emergency stop works without one.")}</p>
    </form>
  );
}

export async function signOut(): Promise<void> {
  await attempt(() => ask("DELETE", "/session"));
  session.value = { state: "out" };
}
