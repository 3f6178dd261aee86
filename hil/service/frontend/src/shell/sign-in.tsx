// A session of the page is opened by a provider where people sign in, or with a token; scripts cannot read its cookie.

import type { JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { API, ask, Refused } from "../api/client.ts";
import type { Health } from "../api/types.ts";
import { attempt, useData } from "../data.ts";
import { t } from "../i18n/text.ts";
import { lookWho, session } from "../session.ts";
import { useStore } from "../store.ts";

// Why the provider's way back signed nobody in, as `?sign_in=` says it.
const REASONS: Record<string, () => string> = {
  late: () => t("The sign-in took too long, was done before, or began in another browser. Sign in once more."),
  declined: () => t("The provider signed nobody in."),
  token: () => t("What the provider sent is not valid. The log of the service says why."),
  no_role: () => t("You are signed in at the provider, but none of your groups has a role here. An administrator assigns roles to groups."),
  provider: () => t("The provider does not answer as it should. The log of the service says why."),
};

export function SignIn(): JSX.Element {
  const health = useData<Health>("/health");
  const [reason] = useState(takeReason);
  const who = useStore(session), ended = who.state === "out" && who.ended;
  const provider = health.data?.sign_in ?? "";
  return (
    <div class="card narrow">
      <h1>{t("Sign in")}</h1>
      {ended ? <p class="alarm" role="alert">{t("You are no longer signed in: the session has ended, or the token was revoked. Sign in again.")}</p> : null}
      {reason ? <p class="alarm" role="alert">{reason}</p> : null}
      {provider ? <p><a class="button main" href={wayIn()}>{t("Sign in with {provider}", { provider })}</a></p> : null}
      {provider ? <details><summary>{t("Sign in with a token")}</summary><TokenForm /></details> : health.loading ? null : <TokenForm first />}
      <p class="quiet">{t("The emergency stop works without signing in.")}</p>
    </div>
  );
}

function TokenForm({ first = false }: { first?: boolean }): JSX.Element {
  const secret = useRef<HTMLInputElement>(null);
  useEffect(() => { if (first) secret.current?.focus(); }, []);
  const submit = async (event: Event) => {
    event.preventDefault();
    const opened = await attempt(async () => { await signIn(secret.current?.value ?? ""); return true; });
    if (opened) await lookWho();
  };
  return (
    <form onSubmit={(event) => void submit(event)}>
      <label class="field">{t("Token")} <input ref={secret} type="password" autocomplete="current-password" required /></label>
      <button type="submit" class="main">{t("Sign in")}</button>
      <p class="quiet">{t("An administrator makes tokens.")}</p>
    </form>
  );
}

// What has other characters than a token is none: how the API's field is called says nothing to a person.
async function signIn(secret: string): Promise<void> {
  try {
    await ask("POST", "/session", { secret });
  } catch (error) {
    if (!(error instanceof Refused) || error.status !== 422) throw error;
    throw new Refused(401, { what: "this token is not known, has expired or was revoked", where: "", fix: "enter it as it was made, without anything around it, or ask an administrator for a new one" });
  }
}

// To the provider, and from there back to the view that was asked for.
const wayIn = (): string => `${API}/sign-in?place=${encodeURIComponent(location.pathname + location.search)}`;

// Shown once: the address that is loaded again or sent does not repeat it.
function takeReason(): string {
  const query = new URLSearchParams(location.search);
  const reason = query.get("sign_in");
  if (reason === null) return "";
  query.delete("sign_in");
  history.replaceState(null, "", location.pathname + (query.size ? `?${query}` : ""));
  return REASONS[reason]?.() ?? "";
}

export async function signOut(): Promise<void> {
  await attempt(() => ask("DELETE", "/session"));
  session.value = { state: "out" };
}
