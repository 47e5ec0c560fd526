classdef Design < dea.Object
  % An actuator as values with units under keys.
  %
  %   d = dea.Design('my.yaml')         a design file (docs/design-file.md)
  %   d = dea.Design.parse(TEXT)        the same as text
  %   d.set('film.thickness', '80 um')  several pairs fit together or not at all
  %   d.get('film.thickness')           struct: text '80 um', si 8e-5, unit 'm', origin ('set'), ...
  %   d.check()                         notes and warnings; an error if it cannot be computed
  %
  % A design is a handle: b = a is the same design, b = a.copy() another one.

  methods
    function self = Design(file)
      if isnumeric(file)
        self.id = file; % of a design that dea_mex has made
      else
        self.id = dea_mex('design_open', char(file));
      end
    end

    function set(self, varargin)
      % set(KEY, VALUE, ...): values as in the file ('80 um', '[100 Hz, 1 kHz]'), or pure numbers.
      if mod(numel(varargin), 2) ~= 0
        error('dea:argument', 'a key without a value');
      end
      texts = cellfun(@dea.value_text, varargin, 'UniformOutput', false);
      dea_mex('design_set', self.id, texts(1:2:end), texts(2:2:end));
    end

    function value = get(self, key)
      % Value of a key, default ones too.
      value = dea_mex('design_get', self.id, char(key));
    end

    function all = values(self)
      % All values as an array of structs, in the order of the schema.
      all = dea_mex('design_values', self.id);
    end

    function other = copy(self)
      other = dea.Design(dea_mex('design_copy', self.id));
    end

    function findings = check(self)
      % Checks all that a run would. Notes and warnings as an array of structs.
      findings = dea_mex('design_check', self.id);
    end

    function text = yaml(self)
      % The design as YAML, with what was set.
      text = dea_mex('design_yaml', self.id);
    end

    function save(self, file)
      % Writes a design file.
      dea_mex('design_save', self.id, char(file));
    end

    function picture = svg(self)
      % The actuator from above and cut along a fibre, as the text of an SVG file.
      picture = dea_mex('design_svg', self.id);
    end

    function disp(self)
      fprintf('  dea.Design\n%s', self.yaml());
    end
  end

  methods (Static)
    function self = parse(text, name)
      % NAME stands for the text in findings.
      if nargin < 2
        name = 'design';
      end
      self = dea.Design(dea_mex('design_parse', char(text), char(name)));
    end
  end
end
