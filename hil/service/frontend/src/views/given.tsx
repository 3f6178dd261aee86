// Models and controllers: shipped ones and those that were given, with their files.

import type { JSX } from "preact";
import { ask } from "../api/client.ts";
import type { Controller, Model } from "../api/types.ts";
import { to } from "../addresses.ts";
import { attempt, useData } from "../data.ts";
import { English } from "../i18n/english.tsx";
import { t } from "../i18n/text.ts";
import { go } from "../router.ts";
import { useMay } from "../session.ts";
import { kindInWords } from "../ui/kinds.ts";
import { Heading, inWords, Loaded, Scroll, Section } from "../ui/parts.tsx";
import { GiveFile } from "./give-file.tsx";
import { UseController } from "./design/use-controller.tsx";
import { FileText } from "./plans/plans.tsx";

export function Models(): JSX.Element {
  const models = useData<Model[]>("/models"), may = useMay();
  return (
    <>
      <Heading>{t("Models")}</Heading>
      <Loaded of={models} what={t("models")}>
        {(all) => (
          <Scroll label={t("Models")}><table>
            <thead><tr><th scope="col">{t("model")}</th><th scope="col">{t("kind")}</th><th scope="col">{t("effects")}</th><th scope="col">{t("origin")}</th></tr></thead>
            <tbody>{all.map((one) => <tr key={one.name}><th scope="row"><a href={to.model(one.name)}>{one.name}</a>{one.warning ? <span class="reason"><English>{one.warning}</English></span> : null}</th><td>{kindInWords(one.kind)}</td><td>{one.effects.map(inWords).join(", ") || "–"}</td><td>{one.built_in ? t("shipped") : t("given")}</td></tr>)}</tbody>
          </table></Scroll>
        )}
      </Loaded>
      {may("engineer") ? <p><a href={to.list("identifications")}>{t("Identify a model from runs")}</a></p> : null}
      {may("engineer") ? <Section title={t("Give a model")} label="give"><GiveFile kind="model" path="/models" ending=".toml" onGiven={(name) => go(to.model(name))} /></Section> : null}
    </>
  );
}

export function Controllers(): JSX.Element {
  const controllers = useData<Controller[]>("/controllers"), may = useMay();
  return (
    <>
      <Heading>{t("Controllers")}</Heading>
      <Loaded of={controllers} what={t("controllers")}>
        {(all) => (
          <Scroll label={t("Controllers")}><table>
            <thead><tr><th scope="col">{t("controller")}</th><th scope="col">{t("stabilisation")}</th><th scope="col">{t("origin")}</th></tr></thead>
            <tbody>{all.map((one) => <tr key={one.name}><th scope="row"><a href={to.controller(one.name)}>{one.name}</a>{one.warnings.map((text) => <span class="reason" key={text}><English>{text}</English></span>)}</th><td>{kindInWords(one.stabilisation)}</td><td>{one.built_in ? t("built in") : t("given")}</td></tr>)}</tbody>
          </table></Scroll>
        )}
      </Loaded>
      {may("engineer") ? <p><a href={to.list("design")}>{t("Design a controller")}</a></p> : null}
      {may("engineer") ? <Section title={t("Give a controller")} label="give"><GiveFile kind="controller" path="/controllers" ending=".toml" onGiven={(name) => go(to.controller(name))} /></Section> : null}
    </>
  );
}

export const ModelView = ({ name }: { name: string }): JSX.Element => <Given name={name} kind="model" path="/models" list="models" />;

export function ControllerView({ name }: { name: string }): JSX.Element {
  const may = useMay();
  return (
    <>
      <Given name={name} kind="controller" path="/controllers" list="controllers" />
      {may("engineer") ? <Section title={t("Use it in a plan")} label="use"><UseController controller={name} /></Section> : null}
    </>
  );
}

interface GivenOptions {
  name: string;
  kind: string;
  path: string;
  list: "models" | "controllers";
}

function Given({ name, kind, path, list }: GivenOptions): JSX.Element {
  const may = useMay(), noun = kindInWords(kind);
  const found = useData<{ name: string; built_in: boolean }[]>(path).data?.find((one) => one.name === name);
  const remove = async () => {
    if (!confirm(t("Remove the {kind} {name}?", { kind: noun, name }))) return;
    if (await attempt(async () => { await ask("DELETE", `${path}/${encodeURIComponent(name)}`); return true; })) go(to.list(list));
  };
  return (
    <>
      <Heading kind={found ? (found.built_in ? t("Shipped {kind}", { kind: noun }) : t("Given {kind}", { kind: noun })) : noun}>{name}</Heading>
      <FileText path={`${path}/${encodeURIComponent(name)}/text`} label={`${noun} ${name}`} />
      {found && !found.built_in && may("engineer") ? <div class="row"><button type="button" onClick={() => void remove()}>{t("Remove the {kind}", { kind: noun })}</button></div> : null}
    </>
  );
}
