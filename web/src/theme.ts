// The style is dark or light according to the system's setting, until the person chooses one of
// them.

export type Theme = 'dark' | 'light';
const kKey = 'predictor.theme';

// These are the colours of the three.js scene. The colours of the page are in app.css.
export const kSceneColors = {
  dark: {background: 0x12161d, floor: 0x1d232c, minor: 0x2a323e, major: 0x3d4857, ghost: 0x8fb4e8,
         path: 0x56c2ff, hemisphere: 1.35, sun: 2.3},
  light: {background: 0xe9edf2, floor: 0xdfe4ea, minor: 0xcdd5de, major: 0xaab6c4, ghost: 0x3b6fb5,
          path: 0x0b74c9, hemisphere: 1.7, sun: 2.1},
} as const;

// The following colours have a meaning. These colours are the same in the scene and in the plots.
export const kMeaning = {
  green: 0x2fbf71, orange: 0xff9f1c, red: 0xf23645, left: 0x35a7ff, right: 0xb57bff,
} as const;

export function hex(color: number): string {
  return `#${color.toString(16).padStart(6, '0')}`;
}

export class ThemeSwitch {
  theme: Theme;

  constructor(private readonly changed: (theme: Theme) => void) {
    const dark = matchMedia('(prefers-color-scheme: dark)');
    this.theme = this.chosen() ?? (dark.matches ? 'dark' : 'light');
    dark.addEventListener('change', () => {
      if (!this.chosen()) this.apply(dark.matches ? 'dark' : 'light');
    });
    document.documentElement.dataset.theme = this.theme;
  }

  toggle() {
    const theme = this.theme === 'dark' ? 'light' : 'dark';
    localStorage.setItem(kKey, theme);
    this.apply(theme);
  }

  private apply(theme: Theme) {
    this.theme = theme;
    document.documentElement.dataset.theme = theme;
    this.changed(theme);
  }

  private chosen(): Theme | null {
    const value = localStorage.getItem(kKey);
    return value === 'dark' || value === 'light' ? value : null;
  }
}
