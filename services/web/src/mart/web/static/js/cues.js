// The words that partners can say by one press, in the order of their keys: 1, 2, 3 …

const WORDS = { have_it: "I have it", go: "Go", wait: "Wait", slower: "Slower", thanks: "Thanks" };

export const CUES = Object.keys(WORDS);

export const cueText = (cue) => WORDS[cue] ?? cue;
