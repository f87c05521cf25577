// Returns texts of the message catalogue by id, with {name} replaced by the value.
import {readFileSync} from 'node:fs';

const catalogue = JSON.parse(readFileSync(
    new URL('../../../src/core/message_catalogue.json', import.meta.url), 'utf8'));

export function message(id, values = {}) {
  if (!(id in catalogue)) throw new Error(`no message ${id}`);
  return catalogue[id].replace(/\{(\w+)\}/g, (whole, name) => values[name] ?? whole);
}

// Returns a text as a sentence without its full stop, such as 'A stop was requested'.
export function capitalised(id) {
  const text = message(id);
  return text[0].toUpperCase() + text.slice(1);
}
