// Texts in the reader's language. The English text is the key; a catalogue gives the others.

export type Values = Record<string, string | number>;

// A whole sentence or name, never a piece of one: word order differs between languages. Values stand in braces.
export const t = (text: string, values: Values = {}): string =>
  text.replace(/\{(\w+)\}/g, (whole, name: string) => String(values[name] ?? whole));
