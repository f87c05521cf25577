// Provides the texts for people, from the catalogue that the program also uses.
import catalogue from '../../src/core/message_catalogue.json';

export type MessageId = keyof typeof catalogue;

// Returns the text of an id, with each {name} replaced by its value.
export function message(id: MessageId, values: Record<string, string> = {}): string {
  return catalogue[id].replace(/\{(\w+)\}/g, (whole, name) => values[name] ?? whole);
}
