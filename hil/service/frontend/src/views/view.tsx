// Which view an address shows.

import type { JSX } from "preact";
import { to, type Place } from "../addresses.ts";
import { Heading } from "../ui/parts.tsx";
import { BenchView } from "./bench.tsx";
import { Benches } from "./benches.tsx";
import { RunView } from "./run.tsx";
import { Runs } from "./runs.tsx";

export function View({ place }: { place: Place }): JSX.Element {
  switch (place.view) {
    case "benches": return <Benches />;
    case "bench": return <BenchView key={place.bench} bench={place.bench} />;
    case "runs": return <Runs />;
    case "run": return <RunView key={place.run} run={place.run} />;
    default: return <Missing path={"path" in place ? place.path : place.view} />;
  }
}

function Missing({ path }: { path: string }): JSX.Element {
  return (
    <>
      <Heading>No such page</Heading>
      <p>{`There is nothing at ${path}. `}<a href={to.list("benches")}>All benches</a></p>
    </>
  );
}
