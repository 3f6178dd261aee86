// Moments in texts of the service, which says them for every zone: shown as those of the reader's clock.

import { exactMoment, moment } from "../format.ts";

const ISO = /\b\d{4}-\d\d-\d\dT\d\d:\d\d(?::\d\d(?:\.\d+)?)?(?:Z|[+-]\d\d:\d\d)/g;
const SECONDS = /T\d\d:\d\d:\d\d/; // said to the second, and shown so
const UTC = /\b(\d{4}-\d\d-\d\d) (\d\d:\d\d) UTC\b/g;

export const withLocalMoments = (text: string): string =>
  text.replace(UTC, "$1T$2Z").replace(ISO, (found) => (Number.isNaN(Date.parse(found)) ? found : SECONDS.test(found) ? exactMoment(found) : moment(found)));
