// Models, controllers and bench files: shipped ones and those that were given, with their files.

import type { ComponentChildren, JSX } from "preact";
import { ask } from "../../api/client.ts";
import type { BenchFile, Controller, Model } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt, useData } from "../../data.ts";
import { itemOf } from "../../editor/drafts.ts";
import { Versions, versionPath } from "../../editor/versions.tsx";
import { English } from "../../i18n/english.tsx";
import { t } from "../../i18n/text.ts";
import { agreed } from "../../question.ts";
import { go } from "../../router.ts";
import { useMay } from "../../session.ts";
import { kindInWords } from "../../ui/kinds.ts";
import { Heading, inWords, Loaded, Scroll, Section } from "../../ui/parts.tsx";
import { UseController } from "../design/use-controller.tsx";
import { NoneThere } from "../none-there.tsx";
import { FileText } from "../plans/plans.tsx";
import { EditFile, FileEditor, useWritten } from "./file-editor.tsx";
import { GiveFile } from "./give-file.tsx";
import { kindOf, type GivenKind } from "./kinds.ts";

export function Models(): JSX.Element {
  const models = useData<Model[]>("/models");
  const write = <a href={to.list("identifications")}>{t("Identify a model from runs")}</a>;
  return (
    <List kind="model" title={t("Models")} also={write}>
      <Loaded of={models} what={t("models")}>
        {(all) => (
          <Scroll label={t("Models")}><table>
            <thead><tr><th scope="col">{t("model")}</th><th scope="col">{t("kind")}</th><th scope="col">{t("effects")}</th><th scope="col">{t("origin")}</th></tr></thead>
            <tbody>{all.map((one) => <tr key={one.name}><th scope="row"><a href={to.model(one.name)}>{one.name}</a>{one.warning ? <span class="reason"><English>{one.warning}</English></span> : null}</th><td>{kindInWords(one.kind)}</td><td>{one.effects.map(inWords).join(", ") || "–"}</td><td>{one.built_in ? t("shipped") : t("given")}</td></tr>)}</tbody>
          </table></Scroll>
        )}
      </Loaded>
    </List>
  );
}

export function Controllers(): JSX.Element {
  const controllers = useData<Controller[]>("/controllers");
  return (
    <List kind="controller" title={t("Controllers")} also={<a href={to.list("design")}>{t("Design a controller")}</a>}>
      <Loaded of={controllers} what={t("controllers")}>
        {(all) => (
          <Scroll label={t("Controllers")}><table>
            <thead><tr><th scope="col">{t("controller")}</th><th scope="col">{t("stabilisation")}</th><th scope="col">{t("origin")}</th></tr></thead>
            <tbody>{all.map((one) => <tr key={one.name}><th scope="row"><a href={to.controller(one.name)}>{one.name}</a>{one.warnings.map((text) => <span class="reason" key={text}><English>{text}</English></span>)}</th><td>{kindInWords(one.stabilisation)}</td><td>{one.built_in ? t("built in") : t("given")}</td></tr>)}</tbody>
          </table></Scroll>
        )}
      </Loaded>
    </List>
  );
}

export function BenchFiles(): JSX.Element {
  const files = useData<BenchFile[]>("/bench-files");
  return (
    <List kind="bench" title={t("Bench files")} also={<a href={to.list("benches")}>{t("Benches of this service")}</a>}>
      <Loaded of={files} what={t("bench files")}>
        {(all) => (
          <Scroll label={t("Bench files")}><table>
            <thead><tr><th scope="col">{t("bench file")}</th><th scope="col">{t("title")}</th><th scope="col">{t("kind")}</th><th scope="col">{t("origin")}</th></tr></thead>
            <tbody>{all.map((one) => <tr key={one.name}><th scope="row"><a href={to.benchFile(one.name)}>{one.name}</a></th><td>{one.title}</td><td>{one.simulated ? t("simulated") : t("hardware")}</td><td>{one.built_in ? t("shipped") : one.served ? t("given, in service") : t("given")}</td></tr>)}</tbody>
          </table></Scroll>
        )}
      </Loaded>
    </List>
  );
}

// A list with what engineers may add to it.
function List({ kind, title, also, children }: { kind: GivenKind; title: string; also: JSX.Element; children: ComponentChildren }): JSX.Element {
  const of = kindOf(kind), may = useMay(), { isNew } = useWritten();
  if (isNew && may("engineer")) return <><Heading kind={<a href={to.list(of.list)}>{title}</a>}>{of.write}</Heading><FileEditor kind={kind} text={of.start} item={kind} /></>;
  const give = { model: t("Give a model"), controller: t("Give a controller"), bench: t("Give a bench file") }[kind];
  return (
    <>
      <Heading>{title}</Heading>
      {children}
      {may("engineer") ? <p class="links"><a href={`${to.list(of.list)}?write=new`}>{of.write}</a> {also}</p> : null}
      {may("engineer") ? <Section title={give} label="give"><GiveFile kind={kind} submit={give} path={of.path} ending=".toml" onGiven={(name) => go(of.address(name))} /></Section> : null}
    </>
  );
}

export const ModelView = ({ name }: { name: string }): JSX.Element => <Given name={name} kind="model" />;

export function BenchFileView({ name }: { name: string }): JSX.Element {
  const may = useMay(), { isOn } = useWritten();
  return (
    <Given name={name} kind="bench">
      {may("engineer") && !isOn ? <ServeBench name={name} /> : null}
    </Given>
  );
}

// What a given bench file simulates becomes a bench of the service, and is none any more.
function ServeBench({ name }: { name: string }): JSX.Element | null {
  const files = useData<BenchFile[]>("/bench-files"), found = files.data?.find((one) => one.name === name);
  if (!found || found.built_in) return null;
  const turn = async () => {
    await attempt(() => ask(found.served ? "DELETE" : "PUT", `/bench-files/${encodeURIComponent(name)}/service`));
    files.again();
  };
  return (
    <Section title={t("Runs on it")} label="service">
      {found.simulated ? <div class="row level"><button type="button" onClick={() => void turn()}>{found.served ? t("Take the bench out of service") : t("Put the bench into service")}</button>{found.served ? <a href={to.bench(name)}>{t("Bench {name}", { name })}</a> : null}</div>
        : <p class="quiet">{t("A bench on hardware is served where its buses are: hil serve --bench FILE, or an agent there.")}</p>}
    </Section>
  );
}

export function ControllerView({ name }: { name: string }): JSX.Element {
  const may = useMay(), { isOn } = useWritten();
  return (
    <Given name={name} kind="controller">
      {may("engineer") && !isOn ? <Section title={t("Use it in a plan")} label="use"><UseController controller={name} /></Section> : null}
    </Given>
  );
}

// `children`: what else there is to do with one that there is.
function Given({ name, kind, children }: { name: string; kind: GivenKind; children?: ComponentChildren }): JSX.Element {
  const may = useMay(), of = kindOf(kind), { isOn, version } = useWritten();
  const all = useData<{ name: string; built_in: boolean }[]>(of.path), found = all.data?.find((one) => one.name === name);
  const textPath = `${of.path}/${encodeURIComponent(name)}/text`, editPath = `${of.address(name)}?write=on`;
  const remove = async () => {
    if (!(await agreed(t("Remove {name}? Its versions stay.", { name }), t("Remove"), t("Cancel")))) return;
    if (await attempt(async () => { await ask("DELETE", `${of.path}/${encodeURIComponent(name)}`); return true; })) go(to.list(of.list));
  };
  // One that was removed is written on from its versions.
  if (all.data && !found && !(isOn && version !== null)) return <NoneThere kind={kind === "bench" ? "bench-file" : kind} name={name}><Versions kind={kind} name={name} textPath={null} editPath={editPath} /></NoneThere>;
  if (all.loading && !all.data) return <p class="quiet">{t("Asking the service …")}</p>;
  if (isOn && may("engineer")) return <><Heading kind={<a href={of.address(name)}>{name}</a>}>{of.edit}</Heading><EditFile key={itemOf(kind, name, version)} kind={kind} name={name} path={version === null ? textPath : versionPath(kind, name, version)} item={itemOf(kind, name, version)} /></>;
  const heading = {
    model: [t("Model"), t("Shipped model"), t("Given model")], controller: [t("Controller"), t("Shipped controller"), t("Given controller")], bench: [t("Bench file"), t("Shipped bench file"), t("Given bench file")],
  }[kind][found ? (found.built_in ? 1 : 2) : 0];
  const removing = { model: t("Remove the model"), controller: t("Remove the controller"), bench: t("Remove the bench file") }[kind];
  return (
    <>
      <Heading kind={heading}>{name}</Heading>
      {may("engineer") ? <p class="links"><a href={editPath}>{t("Write a new version")}</a></p> : null}
      <FileText path={textPath} label={`${kindInWords(kind)} ${name}`} />
      <Versions kind={kind} name={name} textPath={textPath} editPath={editPath} />
      {found && !found.built_in && may("engineer") ? <div class="row"><button type="button" onClick={() => void remove()}>{removing}</button></div> : null}
      {children}
    </>
  );
}
