function [result, stopped] = run(design, varargin)
  % Runs studies on a design.
  %
  %   result = dea.run(design)
  %   result = dea.run(design, 'models', '3d', 'studies', {'sweep', 'modal'})
  %   [result, stopped] = dea.run(...)
  %
  % Options, with what they are when not given:
  %   'models'    those of the design     name or cell array of names (dea.models)
  %   'studies'   those of the design     name or cell array of names (dea.studies)
  %   'folder'    none                    run folder, written as the run goes (docs/results.md)
  %   'replace'   false                   the results that are in the folder
  %   'resume'    false                   go on where the run in the folder stopped
  %   'figures'   true                    in the folder
  %   'progress'  true                    lines about how far it is, at most one a second
  %
  % A run that ends early (Ctrl-C, a solver that fails) is an error. With two outputs it is not:
  % RESULT has what was computed and STOPPED says why; it is '' otherwise.
  o = dea.options(struct('models', {{}}, 'studies', {{}}, 'folder', '', 'replace', false, ...
                         'resume', false, 'figures', true, 'progress', true), varargin);
  arguments = {'run', design.id, cellstr(o.models), cellstr(o.studies), char(o.folder), ...
               o.replace, o.resume, o.figures, ~o.progress};
  if nargout < 2
    result = dea.Result(dea_mex(arguments{:}));
  else
    [id, stopped] = dea_mex(arguments{:});
    result = dea.Result(id);
  end
end
