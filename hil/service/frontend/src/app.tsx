// The frame of every view: menu, who is signed in, the emergency stop, the last refusal.

import type { JSX } from "preact";
import { useEffect } from "preact/hooks";
import { findStopPost } from "./api/client.ts";
import { titleOf, to } from "./addresses.ts";
import { refusal } from "./data.ts";
import { t } from "./i18n/text.ts";
import { useLost } from "./live.ts";
import { dismiss } from "./question.ts";
import { usePlace, useTitle } from "./router.ts";
import { session } from "./session.ts";
import { Aside, Menu } from "./shell/menu.tsx";
import { Palette, paletteOpen } from "./shell/palette.tsx";
import { QuestionWindow } from "./shell/question.tsx";
import { SignIn, signOut } from "./shell/sign-in.tsx";
import { benchInSight, StopButton, StopTrouble } from "./shell/stop.tsx";
import { useStore } from "./store.ts";
import { FieldMessage } from "./ui/field-message.tsx";
import { kindInWords } from "./ui/kinds.ts";
import { Refusal } from "./ui/refusal.tsx";
import { LostNotice } from "./views/bench-banner.tsx";
import { StoppedBenches } from "./views/stopped-benches.tsx";
import { View } from "./views/view.tsx";

const STOP_POST_MS = 5000;

export function App(): JSX.Element {
  const place = usePlace();
  const who = useStore(session);
  useTitle(who.state === "out" ? t("Sign in") : titleOf(place));
  useEffect(() => {
    const look = () => void findStopPost().catch(() => {});
    look();
    const timer = setInterval(look, STOP_POST_MS);
    return () => clearInterval(timer);
  }, []);
  useEffect(() => {
    if ((!("bench" in place) || place.view === "wall") && place.view !== "run") benchInSight.value = "";
    refusal.value = null;
    dismiss(); // it was of the view before
  }, [place]);
  const isLost = useLost();
  useEffect(() => { document.documentElement.classList.toggle("stale", isLost); }, [isLost]); // what is shown is of before
  useEffect(() => { if (who.state === "out") dismiss(); }, [who.state]); // nobody is there who could answer
  if (place.view === "wall" && who.state === "in") return <main id="main"><View place={place} /></main>;
  return (
    <>
      <a class="skip" href="#main" onClick={(event) => { event.preventDefault(); document.getElementById("main")?.focus(); }}>{t("Skip to the content")}</a>
      <header class="top">
        <div class="bar">
          <a class="home" href={to.list("benches")}>{t("Bench service")}</a>
          {who.state === "in" ? <button type="button" class="find" onClick={() => { paletteOpen.value = true; }}>{t("Find")} <kbd>Ctrl K</kbd></button> : null}
          {who.state === "in" ? <Aside place={place} /> : null}
          {who.state === "in" && who.me.tokens ? <span class="who">{`${who.me.name}, ${kindInWords(who.me.role)}`} <button type="button" class="plain" onClick={() => void signOut()}>{t("Sign out")}</button></span> : null}
          <StopButton />
        </div>
        {who.state === "in" ? <Menu place={place} /> : null}
      </header>
      <main id="main" tabIndex={-1}>
        <StopTrouble />
        <LostNotice />
        {who.state === "in" ? <StoppedBenches place={place} /> : null}
        <Refusal of={refusal} />
        {who.state === "in" ? <View place={place} /> : who.state === "out" ? <SignIn /> : <p class="quiet">{t("Asking the service …")}</p>}
      </main>
      {who.state === "in" ? <footer class="foot"><a href={to.list("glossary")}>{t("Words of this page")}</a></footer> : null}
      <FieldMessage />
      <QuestionWindow />
      <Palette />
    </>
  );
}
