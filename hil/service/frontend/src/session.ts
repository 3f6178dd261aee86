// Who uses the page, and what they may do.

import { get, Refused, WHO } from "./api/client.ts";
import { unknown } from "./api/reached.ts";
import { ROLES, type Me, type Role } from "./api/types.ts";
import { refusal } from "./data.ts";
import { Store, useStore } from "./store.ts";

export type Session = { state: "asking" } | { state: "out"; ended?: boolean } | { state: "in"; me: Me };

export const session = new Store<Session>({ state: "asking" });
const AGAIN_MS = 2000;

export async function lookWho(): Promise<void> {
  try {
    session.value = { state: "in", me: await get<Me>(WHO) };
    if (refusal.value instanceof Refused && refusal.value.status === 0) refusal.value = null;
  } catch (error) {
    if (error instanceof Refused && error.status === 401) {
      session.value = { state: "out" };
      return;
    }
    refusal.value = error as Error;
    setTimeout(() => void lookWho(), AGAIN_MS);
  }
}

// A token may be revoked, a session may end or be closed in another tab, while this one shows a bench.
let looking = false;
unknown.subscribe(() => {
  if (looking || session.value.state !== "in") return;
  looking = true;
  void get<Me>(WHO).catch((error: unknown) => {
    if (error instanceof Refused && error.status === 401) session.value = { state: "out", ended: true };
  }).finally(() => { looking = false; });
});

export function useMe(): Me {
  const found = useStore(session);
  return found.state === "in" ? found.me : { name: "", role: "viewer", tokens: true };
}

export function useMay(): (role: Role) => boolean {
  const me = useMe();
  return (role) => ROLES.indexOf(me.role as Role) >= ROLES.indexOf(role);
}
