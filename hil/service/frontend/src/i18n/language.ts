// The reader's language: chosen in this browser, else the first of the browser's that there is a catalogue of.

// Plurals by the categories of Intl.PluralRules; other texts as they are.
export type Catalogue = Record<string, string | Record<string, string>>;

// By their own names. A language is added here, with its file beside this one (docs/how-to/translate.md).
export const LANGUAGES = { en: "English", de: "Deutsch", ja: "日本語" } as const;
export type Language = keyof typeof LANGUAGES;

// A file of its own each, so that readers of English load none.
const CATALOGUES: Record<Exclude<Language, "en">, () => Promise<{ default: Catalogue }>> = {
  de: () => import("./de.json"),
  ja: () => import("./ja.json"),
};

const KEY = "language";
const inBrowser = typeof document !== "undefined"; // tests have none, and read English

const isLanguage = (text: string): text is Language => Object.hasOwn(LANGUAGES, text);

const primaryOf = (tag: string): string => tag.toLowerCase().split("-")[0] ?? "";

export function languageOf(chosen: string | null, preferred: readonly string[]): Language {
  if (chosen !== null && isLanguage(chosen)) return chosen;
  return preferred.map(primaryOf).find(isLanguage) ?? "en";
}

// Numbers and moments follow the language of the texts, in the reader's country's way where the browser says one.
export const localeOf = (language: Language, preferred: readonly string[]): string =>
  preferred.find((tag) => primaryOf(tag) === language) ?? language;

const preferred: readonly string[] = inBrowser ? navigator.languages : ["en"];

// '' while the browser's language is followed.
export const chosenLanguage = inBrowser ? (localStorage.getItem(KEY) ?? "") : "";
export const LANGUAGE = languageOf(chosenLanguage, preferred);
export const LOCALE = localeOf(LANGUAGE, preferred);

// Everything is read anew in the language: the page is loaded once more, at the same address.
export function chooseLanguage(language: Language | ""): void {
  if (language) localStorage.setItem(KEY, language); else localStorage.removeItem(KEY);
  location.reload();
}

async function load(): Promise<Catalogue> {
  document.documentElement.lang = LANGUAGE;
  if (LANGUAGE === "en") return {};
  try {
    return (await CATALOGUES[LANGUAGE]()).default;
  } catch { // a stop button in English is better than none
    document.documentElement.lang = "en";
    return {};
  }
}

// There before any view is: modules may keep texts as constants.
export const CATALOGUE: Catalogue = inBrowser ? await load() : {};
