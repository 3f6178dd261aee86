// Moments in texts of the service, which says them for every zone: shown as those of the reader's clock.

import { moment } from "../format.ts";

const ISO = /\b\d{4}-\d\d-\d\dT\d\d:\d\d(?::\d\d(?:\.\d+)?)?(?:Z|[+-]\d\d:\d\d)/g;
const UTC = /\b(\d{4}-\d\d-\d\d) (\d\d:\d\d) UTC\b/g;

export const withLocalMoments = (text: string): string =>
  text.replace(UTC, "$1T$2:00Z").replace(ISO, (found) => (Number.isNaN(Date.parse(found)) ? found : moment(found)));
