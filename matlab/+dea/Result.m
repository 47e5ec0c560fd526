classdef Result < dea.Object
  % What a run found.
  %
  %   r = dea.run(design, ...)            or dea.Result('FOLDER'), of results.h5 or its folder
  %   p = r.table('3d/sweep')             struct of columns: p.voltage_V, p.centre_z_m, ...
  %   z = r.array('3d/sweep/centre_z_m')  one column; [z, unit, meaning] = ...
  %   m = r.mesh('3d/surface/0004')       points, cells and fields of the film
  %
  % Names of arrays: docs/api.md. Units are SI and in the name.

  methods
    function self = Result(path)
      if isnumeric(path)
        self.id = path; % of a result that dea_mex has made
      else
        self.id = dea_mex('result_open', char(path));
      end
    end

    function all = arrays(self)
      % Array of structs: name, unit, meaning, size.
      all = dea_mex('result_arrays', self.id);
    end

    function [values, unit, meaning] = array(self, name)
      [values, unit, meaning] = dea_mex('result_array', self.id, char(name));
    end

    function columns = table(self, name)
      % The points of a curve ('3d/sweep') or the rows of a profile, as a struct of columns.
      columns = struct();
      for one = self.arrays()'
        [folder, key] = split(one.name);
        if strcmp(folder, char(name))
          columns.(key) = self.array(one.name);
        end
      end
      if isempty(fieldnames(columns))
        error('dea:argument', 'there is nothing in ''%s''; there are: %s', char(name), ...
              strjoin(self.curves(), ', '));
      end
    end

    function names = curves(self)
      % Names of all that has points: 'lumped/sweep', 'lumped/path/pull_in', ...
      all = self.arrays();
      names = unique(cellfun(@split, {all.name}, 'UniformOutput', false), 'stable');
    end

    function found = text(self, name)
      % 'title', 'design', 'summary' (JSON), 'MODEL/STUDY/status', ...
      found = dea_mex('result_text', self.id, char(name));
    end

    function svg = figure(self, name)
      % A figure as the text of an SVG file: 'displacement', 'stretch', 'field', ...; without NAME
      % the first that there is.
      if nargin < 2
        name = '';
      end
      svg = dea_mex('result_figure', self.id, char(name));
    end

    function names = meshes(self)
      % Names of the meshes: '3d/surface/0004' is the film at point 4 of the sweep.
      names = dea_mex('result_meshes', self.id);
    end

    function found = mesh(self, name, whole)
      % The film with its fields; mesh(NAME, false): only the sector that was computed.
      % Struct: points (in m, one row a point), cells (nodes: one row a cell, counted from 1),
      % fields (one row a point or cell), about (unit, meaning, kind of each field), voltage_V.
      if nargin < 3
        whole = true;
      end
      found = dea_mex('result_mesh', self.id, char(name), whole);
    end

    function write(self, folder, varargin)
      % A run folder, as dea run makes it. Options: 'replace', 'figures' (true or false).
      o = dea.options(struct('replace', false, 'figures', true), varargin);
      dea_mex('result_write', self.id, char(folder), o.replace, o.figures);
    end

    function save(self, file)
      % results.h5 alone, to that path.
      dea_mex('result_save', self.id, char(file));
    end

    function found = design(self)
      % The design that was computed, with what was set.
      found = dea.Design(dea_mex('result_design', self.id));
    end

    function disp(self)
      fprintf('  dea.Result ''%s'': %s\n', self.text('title'), strjoin(self.curves(), ', '));
    end
  end
end

function [folder, key] = split(name)
  at = find(name == '/', 1, 'last');
  folder = name(1:at - 1);
  key = name(at + 1:end);
end
