// The words that partners can say by one press.

const WORDS = { have_it: "I have it", go: "Go", wait: "Wait", slower: "Slower", thanks: "Thanks" };

export const cueText = (cue) => WORDS[cue] ?? cue;
