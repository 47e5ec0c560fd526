function stub_log(text)
file = fopen(getenv('STUB_LOG'), 'a');
fprintf(file, '%s\n', text);
fclose(file);
end
