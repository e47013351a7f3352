// Rules for the pages' JavaScript; types are tsc's (tsconfig.json). ESLint 9 and eslint-plugin-jsdoc 50 are the newest
// that run on Node 18, which is Debian 12's; the other packages are the newest.

import js from "@eslint/js";
import jsdoc from "eslint-plugin-jsdoc";
import globals from "globals";

const PAGES = "services/web/src/mart/web/static/js/**/*.js";
const TESTS = "tests/browser/**/*.js"; // run inside a page
const TOOLS = "*.js";

const LONGEST_FILE_LINES = 300;
const LONGEST_FUNCTION_LINES = 60;
const LONGEST_LINE = 120;
const MAX_COMPLEXITY = 10;

const rules = {
  "array-callback-return": "error",
  camelcase: ["error", { properties: "never" }],
  complexity: ["error", MAX_COMPLEXITY],
  curly: ["error", "multi-line"],
  "default-case-last": "error",
  eqeqeq: ["error", "always", { null: "ignore" }],
  "max-len": ["error", { code: LONGEST_LINE, ignoreUrls: true }],
  "max-lines": ["error", LONGEST_FILE_LINES],
  "max-lines-per-function": ["error", LONGEST_FUNCTION_LINES],
  "no-alert": "error",
  "no-console": "error",
  "no-constructor-return": "error",
  "no-duplicate-imports": "error",
  "no-else-return": "error",
  "no-eval": "error",
  "no-implied-eval": "error",
  "no-lonely-if": "error",
  "no-nested-ternary": "error",
  "no-new-func": "error",
  "no-param-reassign": "error",
  "no-promise-executor-return": "error",
  "no-restricted-syntax": [
    "error",
    {
      selector: "AssignmentExpression[left.property.name=/^(inner|outer)HTML$/]",
      message: "Make elements with element() of dom.js: a text never becomes markup.",
    },
  ],
  "no-return-assign": "error",
  "no-self-compare": "error",
  "no-sequences": "error",
  "no-shadow": "error",
  "no-throw-literal": "error",
  "no-unneeded-ternary": "error",
  "no-unreachable-loop": "error",
  "no-unused-expressions": "error",
  "no-use-before-define": ["error", { functions: false, classes: false, variables: false }],
  "no-useless-assignment": "error",
  "no-useless-computed-key": "error",
  "no-useless-rename": "error",
  "no-useless-return": "error",
  "no-var": "error",
  "no-warning-comments": ["error", { terms: ["@ts-ignore", "@ts-nocheck", "fixme", "todo"], location: "anywhere" }],
  "object-shorthand": "error",
  "prefer-arrow-callback": "error",
  "prefer-const": "error",
  "prefer-object-spread": "error",
  "prefer-template": "error",
};

const documentation = {
  "jsdoc/check-alignment": "error",
  "jsdoc/check-param-names": ["error", { checkDestructured: false }],
  "jsdoc/check-tag-names": ["error", { definedTags: ["import"] }],
  "jsdoc/empty-tags": "error",
  "jsdoc/no-bad-blocks": "error",
  "jsdoc/require-jsdoc": [
    "error",
    {
      publicOnly: true,
      checkConstructors: false,
      checkGetters: false,
      enableFixer: false,
      require: {
        ArrowFunctionExpression: true,
        ClassDeclaration: true,
        FunctionDeclaration: true,
        MethodDefinition: true,
      },
      contexts: ["ExportNamedDeclaration > VariableDeclaration"],
    },
  ],
};

export default [
  { ignores: [".*/", "test-output/", "services/web/src/mart/web/static/vendor/"] },
  { linterOptions: { reportUnusedDisableDirectives: "error" } },
  { files: [PAGES, TESTS, TOOLS], ...js.configs.recommended },
  { files: [PAGES, TESTS, TOOLS], rules },
  {
    files: [PAGES],
    languageOptions: { globals: globals.browser },
    plugins: { jsdoc },
    settings: { jsdoc: { mode: "typescript" } },
    rules: documentation,
  },
  {
    files: [TESTS], // each is one function, which a test calls
    languageOptions: { sourceType: "script", globals: globals.browser },
    rules: { "max-lines-per-function": "off", "no-unused-expressions": "off" },
  },
];
