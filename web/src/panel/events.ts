// Lists the scenario's events for the experimenter. The list contains the future events with their
// triggers, and the events that have begun. Only the page at /experimenter receives these events.
import {h} from '../dom';
import {EventPlan, PlannedEvent} from '../protocol';

export function eventWords({trigger, begin, end}: PlannedEvent): string {
  if (begin === null) return `to come: ${trigger}`;
  if (end === null) return `acts since ${begin.toFixed(2)} s`;
  return `acted from ${begin.toFixed(2)} to ${end.toFixed(2)} s`;
}

export class EventsCard {
  private readonly list = h('ol', {id: 'planned-events'});
  private readonly hint = h('p', {class: 'hint'});
  readonly element = h('section', {hidden: true}, h('h3', {}, 'Events'), this.list, this.hint);

  clear() {
    this.element.hidden = true;
  }

  show({events, complete}: EventPlan) {
    this.element.hidden = false;
    this.list.replaceChildren(...events.map((event) => h(
        'li', {'data-state': event.begin === null ? 'to-come' : event.end === null ? 'acts' : 'over'},
        h('b', {}, event.event), ` (${event.meaning}) `, h('span', {}, eventWords(event)))));
    this.hint.textContent = [
      events.length === 0 ? 'The scenario has no events.' : 'Do not show this page to the subject.',
      complete ? '' : 'The server restarted: events that had already ended are listed as to come.',
    ].filter((words) => words !== '').join(' ');
  }
}
