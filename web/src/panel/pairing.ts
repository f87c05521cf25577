// Shows the form for the six digits if the address contains no code.
import {h, setText} from '../dom';

const kDigits = 6;

export class PairingPage {
  readonly element: HTMLElement;
  private readonly input: HTMLInputElement;
  private readonly button: HTMLButtonElement;
  private readonly error: HTMLElement;
  private readonly emergency = h('p', {class: 'emergency', role: 'alert', hidden: true},
                                 'Use the robot’s emergency stop');

  constructor(private readonly submit: (pin: string) => void) {
    this.input = h('input', {
      id: 'pin', name: 'pin', inputmode: 'numeric', autocomplete: 'one-time-code',
      maxlength: kDigits, pattern: '[0-9]{6}', placeholder: '••••••',
      'aria-describedby': 'pin-error', oninput: () => this.changed(),
    });
    this.button = h('button', {class: 'primary', type: 'submit', id: 'pair', disabled: true},
                    'Connect');
    this.error = h('p', {id: 'pin-error', class: 'error', role: 'alert'});
    this.element = h(
        'main', {class: 'pairing', hidden: true},
        h('form', {class: 'card', onsubmit: (event) => this.submitted(event)},
          h('h1', {}, 'PREDICTOR'), this.emergency,
          h('p', {}, 'Type the six digits that the console shows.'),
          h('label', {for: 'pin'}, 'Digits'), this.input, this.error, this.button,
          h('p', {class: 'hint'},
            'No digits yet? Open the address that the program printed, or ask the person at the ' +
            'console for digits. They are valid for two minutes.')));
  }

  // `lost` states whether the page was connected to real arms until now, so that it could stop
  // them.
  show(reason: string, lost: boolean) {
    this.element.hidden = false;
    this.emergency.hidden = !lost;
    setText(this.error, reason);
    this.input.value = '';
    this.changed();
    this.input.focus();
  }

  hide() {
    this.element.hidden = true;
  }

  private changed() {
    this.input.value = this.input.value.replace(/\D/g, '');
    this.button.disabled = this.input.value.length !== kDigits;
  }

  private submitted(event: Event) {
    event.preventDefault();
    if (this.input.value.length === kDigits) this.submit(this.input.value);
  }
}
