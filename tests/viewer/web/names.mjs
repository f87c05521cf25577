// The names and fields of a state, from the page's generated source. tests/viewer/frame_test.cpp
// compares this source with the program's table of quantities.
import {readFileSync} from 'node:fs';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const source = readFileSync(
    join(dirname(fileURLToPath(import.meta.url)), '../../../web/src/quantities.ts'), 'utf8');

function list(name) {
  const [, text] = source.match(new RegExp(`export const ${name} = \\[([^\\]]*)\\]`));
  return text.match(/\w+/g);
}

export const kStates = list('kRunStates');
export const kCauses = list('kStopCauses');

// Returns the [name, type, count] of each field.
function fields(name) {
  const [, text] = source.match(new RegExp(`export const ${name} = \\{([^}]*)\\}`));
  return [...text.matchAll(/(\w+): \['\w+', '\w+', '(\w+)', (\d+)\]/g)].map(
      ([, field, type, count]) => [field, type, Number(count)]);
}

export const kRunFields = fields('kRunFields');
export const kHandFields = fields('kHandFields');
